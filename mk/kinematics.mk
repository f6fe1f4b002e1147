# Sweeps over simulated machines that take too long for a test.

.PHONY: kinematics-sweep
kinematics-sweep: COUNT = 1000
kinematics-sweep: setup setup-test ## what cycle 451 leaves on COUNT machines of every type
	@PYTHONPATH=tests/python $(VENV_PYTHON) tests/python/kinematics_sweep.py \
	    --count $(COUNT) --jobs $(shell nproc)
