# How many small changes of the firmware's core, and of the verdict's rules, their tests notice.

.PHONY: mutants mutants-firmware mutants-rules
mutants: mutants-firmware mutants-rules ## change the firmware's core and the verdict's rules in small ways and count what the tests notice
mutants-firmware: setup setup-test
	@nice $(VENV_PYTHON) -m tests.mutation.score $(if $(DRAWN),--count $(DRAWN)) $(MUTATED)
mutants-rules: setup setup-test
	@nice $(VENV_PYTHON) -m tests.mutation.python_score $(if $(DRAWN),--count $(DRAWN))
