# The loop of a change: what takes no time.

QUICK_S ?= 2

.PHONY: quick run-quick
quick: setup-build $(STAMPS)/system-test $(STAMPS)/cmock ## compile, check the layout of Python, run unit tests and the test files that take under QUICK_S=2
	@$(INNER_MAKE) run-quick
run-quick: library program $(OUT)/inject-codec $(TESTS.unit:%.c=$(OUT)/%)
	@.venv/bin/ruff check --quiet --config scripts/pyproject.toml $(PYTHON_FOLDERS)
	@.venv/bin/ruff format --quiet --check --config scripts/pyproject.toml $(PYTHON_FOLDERS)
	@for test in $(TESTS.unit:%.c=$(OUT)/%); do \
	    timeout 10 $$test >$(OUT)/quick.log 2>&1 || { cat $(OUT)/quick.log; exit 1; }; done
	@$(ONE_THREAD) $(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) --numprocesses=$(shell nproc) --quiet -m 'not long' \
	    $$(git diff --name-only --diff-filter=d HEAD -- 'tests/python/test_*.py') \
	    $$($(VENV_PYTHON) scripts/quick_tests.py $(RESULTS)/python/pytest.xml $(QUICK_S) tests/python)
