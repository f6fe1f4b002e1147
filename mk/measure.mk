# What is measured on this host: reach of the tests, speed, the diagnosis on sealed campaigns.

COVERAGE         := $(VENV_PYTHON) -m coverage
COVERAGE_OPTIONS := --rcfile=scripts/pyproject.toml --data-file=build/coverage/python
.PHONY: coverage
coverage: setup setup-test ## run all tests and report what they reach, in build/coverage/report
	@rm -rf build/coverage/report && mkdir -p build/coverage/report/c
	@find build/coverage -name '*.gcda' -delete
	@$(INNER_MAKE) VARIANT=coverage library
	-@$(MAKE) VARIANT=coverage c-tests
	@.venv/bin/gcovr --root . --object-directory build/coverage \
	    --filter firmware/ --filter host_sim/ --filter scripts/ --print-summary \
	    --txt build/coverage/report/c.txt --html-details build/coverage/report/c/index.html
	-@$(COVERAGE) run $(COVERAGE_OPTIONS) -m pytest $(PYTEST_OPTIONS) --quiet tests/python
	@$(COVERAGE) report $(COVERAGE_OPTIONS) | tee build/coverage/report/python.txt

build/perf/libfloor.so: $(call object_of,$(PERF)) $(OUT)/libskiplatch_sim.a
	@mkdir -p $(@D)
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) -shared $^ -lm -o $@

.PHONY: bench
bench: setup $(STAMPS)/bench $(STAMPS)/system-rig ## measure speed
	@$(INNER_MAKE) $(if $(PERF),build/perf/libfloor.so) $(HOSTED_RIG:%.c=$(OUT)/%) program
	@$(VENV_PYTHON) tests/perf/bench.py
	@$(VENV_PYTHON) -m tests.bench.latency

.PHONY: bench-spread
bench-spread: setup ## measure what spreading over workers costs, alone
	@$(VENV_PYTHON) tests/perf/spread_bench.py $(OPTIONS)

COUNT        ?= 20
SEED         ?= 1
FALSE_ALARMS ?= 0
TIES         ?= 0
PLANTED      ?= 0
CLUSTER      ?=
ON_CLUSTER    = $(if $(CLUSTER),--cluster $(CLUSTER))
.PHONY: gap-check
gap-check: setup ## diagnose COUNT=20 campaigns whose effects are sealed, and score that
	@$(VENV_PYTHON) -m tests.withheld.check --count $(COUNT) --seed $(SEED) --jobs $(shell nproc) \
	    --false-alarms $(FALSE_ALARMS) $(ON_CLUSTER) $(OPTIONS)
	$(if $(filter-out 0,$(TIES)),@$(VENV_PYTHON) -m tests.withheld.ties --count $(TIES) \
	    --seed $(SEED) --jobs $(shell nproc) $(ON_CLUSTER))
	$(if $(filter-out 0,$(PLANTED)),@$(VENV_PYTHON) -m tests.withheld.planted --count $(PLANTED) \
	    --seed $(SEED) --jobs $(shell nproc) $(ON_CLUSTER))
