# The project in a Debian that has nothing yet.

SUITE   ?= $(shell . /etc/os-release && echo $$VERSION_CODENAME)
TARGETS ?= demo test
.PHONY: fresh
fresh: $(STAMPS)/system-fresh ## `make demo` and `make test` in a bare Debian, SUITE=bookworm or trixie, as root
	@scripts/fresh.sh $(SUITE) $(TARGETS)
