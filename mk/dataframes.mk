# Data frames of the interface for Python, docs/API.md: extras, as skiplatch needs neither library.

.PHONY: dataframes
dataframes: setup-build ## install pandas and polars for `to_dataframe`, and try both
	@$(VENV_PYTHON) -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement scripts/requirements-dataframes.lock
	@$(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) -rs tests/python/test_api.py -k data_frames
