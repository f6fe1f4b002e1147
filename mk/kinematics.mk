# Sweeps over simulated machines that take too long for a test.

.PHONY: kinematics-sweep
kinematics-sweep: COUNT = 1000
kinematics-sweep: TYPE =
kinematics-sweep: setup setup-test ## what cycle 451 leaves on COUNT machines of every type, or of TYPE
	@PYTHONPATH=tests/python $(VENV_PYTHON) tests/python/kinematics_sweep.py \
	    --count $(COUNT) --type "$(TYPE)" --jobs $(shell nproc)
