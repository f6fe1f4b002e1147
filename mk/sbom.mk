# What the project stands on.

.PHONY: sbom
sbom: setup ## list the locked Python packages in build/sbom.json (CycloneDX), and check their licences
	@$(VENV_PYTHON) scripts/lint/sbom.py build/sbom.json $(SETUP_LOCKS)
