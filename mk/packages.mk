# The firmware as others take it up: docs/PACKAGES.md.

setup-test: build/stamps/system-packages
build/stamps/system-packages: scripts/setup_system.sh
	@scripts/setup_system.sh packages || echo 'SKIPPED: no packages of the group packages to be had here'
	@mkdir -p $(@D) && touch $@

.PHONY: packages
packages: setup setup-test ## build every package of the firmware and use it
	@$(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) -rs tests/python/test_packages_*.py
