# Proofs by the model checker CBMC: for any state and any input, not for those of a test.

.PHONY: prove
prove: setup ## prove the core by CBMC, and show that each proof fails on seeded mutants
	@scripts/setup/cbmc.sh
	@nice $(VENV_PYTHON) tests/proofs/prove.py $(PROOFS)

# The same as a suite: an outcome for each proof and its mutants.
# Those that take longest begin first: at the end nothing waits for one alone.
LONGEST_PROOFS := prove_guard prove_store prove_slots
ALL_PROOFS     := $(patsubst tests/proofs/%.c,%,$(wildcard tests/proofs/prove_*.c))
RESULTS.proofs := $(patsubst %,$(RESULTS)/proofs/%.check,\
    $(filter $(LONGEST_PROOFS),$(ALL_PROOFS)) $(filter-out $(LONGEST_PROOFS),$(ALL_PROOFS)))

.PHONY: proofs run-proofs
proofs: setup ## run the proofs as a suite whose outcomes are counted
	@scripts/setup/cbmc.sh || true
	$(call run_suites,proofs)
run-proofs: $(RESULTS.proofs)
$(RESULTS.proofs): $(RESULTS)/proofs/%.check: FORCE
	$(check) $(if $(wildcard build/cbmc/cbmc),$(VENV_PYTHON) tests/proofs/prove.py --jobs 1 $*,\
	    $(call skip,no CBMC 6 here))
