# A release: what it needs is checked; the tag is made only when asked for.

.PHONY: release
release: setup setup-lint ## check all that a release needs; TAG=yes also makes the tag
	@$(VENV_PYTHON) scripts/release.py
	@$(MAKE) lint test long docs wheel
	@$(VENV_PYTHON) scripts/release.py --built $(WHEEL) $(if $(filter yes,$(TAG)),--tag)
