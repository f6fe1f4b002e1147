# What has to be installed.

STAMPS      := build/stamps
VENV_PYTHON := .venv/bin/python
VENV        := .venv/skiplatch.key
SETUP_LOCKS := scripts/requirements.lock scripts/requirements-fleet.lock scripts/requirements-cluster.lock

$(STAMPS)/system-%: scripts/setup/system.sh
	@scripts/setup/system.sh $*
	@mkdir -p $(@D) && touch $@

$(STAMPS)/cmock: scripts/setup/cmock.sh
	@scripts/setup/cmock.sh
	@mkdir -p $(@D) && touch $@

# What needs an absent cross compiler, emulator or tool of the rig is counted as skipped.
$(addprefix $(STAMPS)/system-,cross emulators riscv rig fresh): $(STAMPS)/system-%: scripts/setup/system.sh
	@scripts/setup/system.sh $* || echo 'SKIPPED: no packages of the group $* to be had here'
	@mkdir -p $(@D) && touch $@

# What a board wants beyond that.
$(STAMPS)/board-%: hal/ports/%/setup.sh | $$(if $$(filter $$*,$(BOARDS)),$(STAMPS)/system-emulators)
	@$< || echo 'SKIPPED: what the board $* needs is not to be had here'
	@mkdir -p $(@D) && touch $@

$(VENV): scripts/setup/python.sh $(SETUP_LOCKS) scripts/pyproject.toml | $(STAMPS)/system-build
	@scripts/setup/python.sh

setup_of = $(patsubst hal/ports/%/setup.sh,$(STAMPS)/board-%,$(wildcard $(1:%=hal/ports/%/setup.sh)))

.PHONY: setup-build setup-test setup-lint
setup-build: $(STAMPS)/system-build $(call setup_of,$(call ports_of,hosted)) $(VENV)
setup-test: setup-build $(STAMPS)/system-test $(STAMPS)/cmock \
            $(STAMPS)/system-cross $(STAMPS)/system-emulators $(STAMPS)/system-riscv \
            $(call setup_of,$(BOARDS))
setup-lint: setup-test $(STAMPS)/system-lint $(STAMPS)/system-cross

# Without the general tool that the diagnosis is compared with, the rest of the benchmark still runs.
$(STAMPS)/bench: scripts/requirements-bench.lock $(VENV)
	@mkdir -p $(@D)
	@$(VENV_PYTHON) -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement $< && touch $@ || echo 'SKIPPED: no pyABC to be had here'
