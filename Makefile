# skiplatch: set-up, build, tests and checks. `make help` lists what there is to call.
#
# Everything lands in build/ and .venv/. What is called by hand runs in order; the compiling and the
# checking behind it run in a second make (the INNER one), on all processors.
#
# The rules stand in mk/, a file a subject; what is to be known of a board in hal/ports/BOARD/board.mk.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SECONDARY:
.SECONDEXPANSION:
MAKEFLAGS += --no-builtin-rules --no-builtin-variables --no-print-directory
ifndef INNER
.NOTPARALLEL:
endif

# make V=1 shows the commands themselves.
SAY := $(if $(V),@:,@echo)
Q   := $(if $(V),,@)

# One tree of objects for each way to compile: mk/variants.mk.
VARIANT  ?= host
OUT      := build/$(VARIANT)
RESULTS  ?= $(if $(filter host,$(VARIANT)),build,$(OUT))/results

# On all processors, unless the caller has said how many with -j.
JOBS        = $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$(shell nproc))
INNER_MAKE  = $(MAKE) INNER=yes --keep-going $(JOBS)

# Each of these uses what those before it define; the order of the others does not matter.
SUBJECTS := boards variants setup sources compile tests suites
MK       := $(SUBJECTS:%=mk/%.mk)
include $(MK) $(filter-out $(MK),$(wildcard mk/*.mk))

# Each process of Python would compile all sources anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: FORCE

# ---- what is called by hand; more of it in mk/ ---------------------------------------------------

.PHONY: help
help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1	/p' $(filter %Makefile %.mk,$(MAKEFILE_LIST)) | \
	    awk -F '\t' '{ printf "  %-12s %s\n", $$1, $$2 }'
	@printf '  %-12s %s\n' SUITE 'set up and run one suite of the tests: $(filter-out target-%,$(TEST_SUITES)) target-BOARD'

.PHONY: setup
setup: setup-build compile_commands.json ## install what is missing, make .venv and the simulator's library
	@$(INNER_MAKE) library program

.PHONY: demo
demo: setup ## set up and run a small campaign into build/demo
	@.venv/bin/skiplatch demo --out build/demo

.PHONY: test
test: setup setup-test ## set up and run every test but the long ones
	$(call run_suites,$(TEST_SUITES))

.PHONY: long
long: setup setup-test ## run the tests that take long: whole diagnoses of two effects, and of the rig
	$(call run_suites,$@)

.PHONY: nightly
nightly: setup setup-test ## run what repeats other tests, with more seeds, draws and sizes
	$(call run_suites,$@)

.PHONY: lint
lint: setup-lint ## set up and run every static check
	@$(INNER_MAKE) generated
	$(call run_suites,lint)

.PHONY: format
format: setup-build ## lay out C and Python files as lint wants them
	@$(if $(C_FILES),.venv/bin/clang-format -i $(C_FILES))
	@.venv/bin/ruff check --quiet --config scripts/pyproject.toml --select I --fix $(PYTHON_FOLDERS)
	@.venv/bin/ruff format --config scripts/pyproject.toml $(PYTHON_FOLDERS)

.PHONY: totals
totals:
	@python3 scripts/count_tests.py $(RESULTS) $(TEST_SUITES) lint sanitize proofs \
	    $(notdir $(wildcard $(addprefix $(RESULTS)/,long nightly bench-vm)))

.PHONY: clean
clean: ## remove what was built
	rm -rf build compile_commands.json

.PHONY: distclean
distclean: clean ## remove .venv as well
	rm -rf .venv scripts/*.egg-info

-include $(shell find $(OUT) -name '*.d' 2>/dev/null)
