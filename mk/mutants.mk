# How many small changes of the firmware's core its unit tests notice.

.PHONY: mutants
mutants: setup setup-test ## change the firmware's core in small ways and count what the unit tests notice
	@nice $(VENV_PYTHON) -m tests.mutation.score $(if $(DRAWN),--count $(DRAWN)) $(MUTATED)
