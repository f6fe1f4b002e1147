# The site, and the pages for man: docs/, and what the commands print of themselves.

SITE      := build/docs
SITE_VENV := $(SITE)/venv

$(SITE_VENV)/venv.key: scripts/requirements-docs.lock | $(VENV)
	@mkdir -p $(@D) && python3 -m venv --clear $(SITE_VENV)
	@$(SITE_VENV)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement $< && touch $@

.PHONY: docs
docs: setup $(SITE_VENV)/venv.key ## write the site into build/site and pages for man into build/man; every link is checked
	@$(VENV_PYTHON) scripts/site_pages.py $(SITE)/pages build/man
	@SITE_URL='$(SITE_URL)' NO_MKDOCS_2_WARNING=1 $(SITE_VENV)/bin/mkdocs build --quiet --strict --config-file scripts/mkdocs.yml
# Neither says anything without the address: the one is empty, the other looks for its style at /.
	@$(if $(SITE_URL),,rm -f build/site/sitemap.xml build/site/sitemap.xml.gz build/site/404.html)
