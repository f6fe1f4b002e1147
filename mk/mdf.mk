# Recordings in ASAM's MDF: an extra, as it brings many packages.

.PHONY: mdf
mdf: setup-build ## install asammdf for 'skiplatch import mdf', and try it
	@$(VENV_PYTHON) -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement scripts/requirements-mdf.lock
	@$(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) -rs tests/python/test_import_mdf.py
