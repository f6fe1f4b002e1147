# Proofs by the model checker CBMC: for any state and any input, not for those of a test.

.PHONY: prove
prove: setup ## prove the core by CBMC, and show that each proof fails on seeded mutants
	@scripts/setup/cbmc.sh
	@nice $(VENV_PYTHON) tests/proofs/prove.py $(PROOFS)

# The same as a suite: an outcome for each proof and its mutants.
RESULTS.proofs := $(patsubst tests/proofs/%.c,$(RESULTS)/proofs/%.check,$(wildcard tests/proofs/prove_*.c))

.PHONY: proofs run-proofs
proofs: setup ## run the proofs as a suite whose outcomes are counted
	@scripts/setup/cbmc.sh || true
	$(call run_suites,proofs)
run-proofs: $(RESULTS.proofs)
$(RESULTS.proofs): $(RESULTS)/proofs/%.check: FORCE
	$(check) $(if $(wildcard build/cbmc/cbmc),$(VENV_PYTHON) tests/proofs/prove.py --jobs 1 $*,\
	    $(call skip,no CBMC 6 here))
