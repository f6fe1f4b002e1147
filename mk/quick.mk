# The loop of a change: what takes no time.

QUICK_S ?= 1

.PHONY: quick run-quick
quick: setup-build $(STAMPS)/system-test $(STAMPS)/cmock ## compile, check the layout of Python, run unit tests and the test files that take under QUICK_S=1
	@$(INNER_MAKE) run-quick
run-quick: library program $(OUT)/inject-codec $(TESTS.unit:%.c=$(OUT)/%)
	@.venv/bin/ruff check --quiet --config scripts/pyproject.toml $(PYTHON_FOLDERS)
	@.venv/bin/ruff format --quiet --check --config scripts/pyproject.toml $(PYTHON_FOLDERS)
	@printf '%s\n' $(TESTS.unit:%.c=$(OUT)/%) | xargs -P $(shell nproc) -I TEST sh -c \
	    'timeout 60 TEST >TEST.log 2>&1 || { cat TEST.log; echo "TEST: failed"; exit 255; }'
	@files=$$($(VENV_PYTHON) scripts/quick_tests.py $(RESULTS)/python/pytest.xml $(QUICK_S) tests/python); \
	    [ -z "$$files" ] || $(ONE_THREAD) $(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) \
	        --numprocesses=$(shell nproc) --quiet -m '$(QUICK_MARKED)' $$files || exit; \
	    awk -v python="$$(echo $$files | wc -w)" '/ Tests .* Failures / { tests += $$1 } \
	        END { printf "quick: %d tests of C in %d files and %d test files of Python passed\n", \
	            tests, ARGC - 1, python }' $(TESTS.unit:%.c=$(OUT)/%.log)
