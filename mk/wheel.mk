# The Python package for machines without a checkout or a compiler: docs/PACKAGES.md.

WHEEL        := build/wheel
WHEEL_PYTHON := $(WHEEL)/venv/bin/python

$(WHEEL)/venv.key: scripts/requirements-wheel.lock | $(VENV)
	@mkdir -p $(@D) && python3 -m venv --clear $(WHEEL)/venv
	@$(WHEEL_PYTHON) -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement $< && touch $@

.PHONY: wheel
wheel: setup-build $(WHEEL)/venv.key ## build the Python package as a wheel and an sdist, into build/wheel
	@$(WHEEL_PYTHON) scripts/pack_python.py $(WHEEL) --flags=$(call quoted,$(filter-out -g,$(FLAGS))) \
	    --sources $(IN_LIBRARY) --shown $(filter $(SHOWN),$(FIRMWARE)) \
	    --includes $(INCLUDES:-I%=%)
