# The firmware as others take it up: docs/PACKAGES.md.

PACKAGE_TOOLS := build/stamps/system-packages build/stamps/system-arduino

setup-test: $(PACKAGE_TOOLS)
$(PACKAGE_TOOLS): build/stamps/system-%: scripts/setup/system.sh
	@scripts/setup/system.sh $* || echo 'SKIPPED: no packages of the group $* to be had here'
	@mkdir -p $(@D) && touch $@

# Without it, what is built by PlatformIO is skipped.
PLATFORMIO := build/platformio/venv
setup-test: $(PLATFORMIO).key
$(PLATFORMIO).key: scripts/requirements-platformio.lock | $(VENV)
	@mkdir -p $(@D) && python3 -m venv --clear $(PLATFORMIO)
	@$(PLATFORMIO)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement $< && touch $@ || { rm -rf $(PLATFORMIO); echo 'SKIPPED: no PlatformIO to be had here'; }

.PHONY: packages
packages: setup setup-test ## build every package of the firmware and use it, into build/packages
	@$(INNER_MAKE) $(OUT)/inject-codec
	@$(VENV_PYTHON) scripts/pack_firmware.py build/packages
	@$(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) -rs tests/python/test_packages_*.py
