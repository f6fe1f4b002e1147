# Proofs by the model checker CBMC: for any state and any input, not for those of a test.

.PHONY: prove
prove: setup ## prove the core by CBMC, and show that each proof fails on seeded mutants
	@scripts/setup_cbmc.sh
	@nice $(VENV_PYTHON) tests/proofs/prove.py $(PROOFS)
