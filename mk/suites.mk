# The suites: what each consists of, how its outcomes come to be and are counted.

C_SUITES    := unit contract scenario
ON_BOARDS   := $(BOARDS:%=target-%)
TEST_SUITES := $(C_SUITES) host-ports $(HOSTED_SUITES) $(ON_BOARDS) fuzz-regression python

# In a make of its own: this one was read before the set-up, and does not know what is here since.
define run_suites
	@$(MAKE) counted SUITES='$1'
endef

# Every result first becomes an empty file: what does not build or run is then counted as failed.
.PHONY: counted
counted:
	@rm -rf $(addprefix $(RESULTS)/,$(SUITES)) && mkdir -p $(addprefix $(RESULTS)/,$(SUITES))
	@touch $(RESULTS)/.declared $(foreach suite,$(SUITES),$(RESULTS.$(suite)))
	-@$(INNER_MAKE) $(addprefix run-,$(SUITES))
	@$(VENV_PYTHON) scripts/count_tests.py $(RESULTS) $(SUITES)

.PHONY: $(TEST_SUITES)
$(TEST_SUITES): setup setup-test # one suite alone, e.g. make unit
	$(call run_suites,$@)

.PHONY: c-tests
c-tests:
	$(call run_suites,$(C_SUITES))

result_of               = $(patsubst %,$(RESULTS)/$1/%.log,$(notdir $(basename $(TESTS.$1))))
RESULTS.unit            := $(call result_of,unit)
RESULTS.contract        := $(call result_of,contract)
RESULTS.scenario        := $(call result_of,scenario)
RESULTS.host-ports      := $(HOST_PORTS:%=$(RESULTS)/host-ports/%.check)
RESULTS.fuzz-regression := $(FUZZ:tests/fuzz/%.c=$(RESULTS)/fuzz-regression/%.check)
RESULTS.python          := $(if $(wildcard tests/python/test_*.py),$(RESULTS)/python/pytest.xml)
RESULTS.long            := $(if $(wildcard tests/python/test_*.py),$(RESULTS)/long/pytest.xml)
RESULTS.nightly         := $(if $(wildcard tests/python/test_*.py),$(RESULTS)/nightly/pytest.xml)

.PHONY: $(addprefix run-,$(C_SUITES) host-ports python long nightly)
$(addprefix run-,$(C_SUITES) host-ports python long nightly): run-%: $$(RESULTS.$$*)
	@:

check = @scripts/run_check.sh $@ $(basename $(@F))
skip  = sh -c 'echo "$1"; exit 77'
# $(call with_tool,avr-gcc,command): the command, or a loud skip where the tool is absent.
with_tool = $(if $(shell command -v $1),$2,$(call skip,no $1 here))

TEST_TIMEOUT_S := 300
define result_rules
$(RESULTS)/$2/$(notdir $1).log: $(OUT)/$1 FORCE
	@timeout $(TEST_TIMEOUT_S) $$< >$$@ 2>&1; echo "exit status $$$$?" >>$$@
	@printf '%-40s %s\n' '$2/$(notdir $1)' "$$$$(grep -E '^[0-9]+ Tests ' $$@ || tail -n 1 $$@)"
endef
$(foreach suite,$(C_SUITES),$(foreach test,$(TESTS.$(suite):.c=),\
    $(eval $(call result_rules,$(test),$(suite)))))

$(RESULTS.host-ports): $(RESULTS)/host-ports/%.check: $(OUT)/ports/% FORCE
	$(check) true

PYTHON_TESTS   := tests/python $(sort $(dir $(wildcard hal/ports/*/tests/test_*.py)))
PYTEST_OPTIONS := -c scripts/pyproject.toml --rootdir=. -o cache_dir=build/pytest_cache
PYTEST_XML     := $(RESULTS.python) $(RESULTS.long) $(RESULTS.nightly)
QUICK_MARKED   := not long and not nightly
$(RESULTS)/python/pytest.xml:  MARKED = $(QUICK_MARKED)
$(RESULTS)/long/pytest.xml:    MARKED = long and not nightly
$(RESULTS)/nightly/pytest.xml: MARKED = nightly
# Processes fill the processors: threads under their linear algebra would only wait for one another.
ONE_THREAD := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
# A file's tests share what is dear to make, and the last files are short ones. Of long ones those share
# that are marked as a group, which begin: tests/python/conftest.py.
$(RESULTS)/python/pytest.xml: PYTEST_DIST = loadfile --no-loadscope-reorder
$(RESULTS)/long/pytest.xml $(RESULTS)/nightly/pytest.xml: PYTEST_DIST = loadgroup
# Files without the mark need not be read.
marked_tests = $(shell grep -l 'mark\.$1' $(PYTHON_TESTS:%=%/test_*.py))
$(RESULTS)/long/pytest.xml:    MARKED_TESTS = $(call marked_tests,long)
$(RESULTS)/nightly/pytest.xml: MARKED_TESTS = $(call marked_tests,nightly)
$(PYTEST_XML):                library program $(OUT)/inject-codec $(RUN_HERE:%=programs-%) FORCE
	@$(ONE_THREAD) $(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) --numprocesses=$(shell nproc) --dist=$(PYTEST_DIST) \
	    -m '$(MARKED)' --quiet --junitxml=$@ $(or $(MARKED_TESTS),$(PYTHON_TESTS)) || true
