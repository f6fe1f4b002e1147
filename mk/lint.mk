# Static checks, each of them a check of the suite `lint`.

ON_CROSS := $(addprefix compile-,$(BOARDS) $(CORES))
# The one process that takes longest begins first, so that none has to wait for it at the end.
LINT := mypy compile-gcc compile-clang analyzer $(ON_CROSS) clang-format clang-tidy cppcheck \
        dependencies firmware isr-calls size ruff-check ruff-format shellcheck licences
RESULTS.lint := $(LINT:%=$(RESULTS)/lint/%.check)

.PHONY: run-lint
run-lint: $(RESULTS.lint)
	@:

$(RESULTS)/lint/compile-gcc.check: FORCE
	$(check) $(MAKE) VARIANT=gcc objects
$(RESULTS)/lint/compile-clang.check: FORCE
	$(check) $(MAKE) VARIANT=clang objects
$(RESULTS)/lint/analyzer.check: FORCE
	$(check) $(MAKE) VARIANT=analyzer analyzed
# What is linked of a board is there before: two makes at once would write the same objects.
$(ON_CROSS:%=$(RESULTS)/lint/%.check): $(RESULTS)/lint/compile-%.check: \
        $$(addprefix linked-,$$(filter $$*,$(LINKED))) FORCE
	$(check) $(call with_tool,$(CC.$(FAMILY.$*)),$(MAKE) VARIANT=boards/$* objects)

$(RESULTS)/lint/clang-format.check: FORCE
	$(check) .venv/bin/clang-format --dry-run -Werror $(or $(C_FILES),--version)
$(RESULTS)/lint/clang-tidy.check: FORCE
	$(check) $(MAKE) VARIANT=clang tidy
$(RESULTS)/lint/cppcheck.check: FORCE
	$(check) $(VENV_PYTHON) scripts/lint/lint_cppcheck.py build/cppcheck \
	    --portable $(HOST_PORTS:%=hal/ports/%) --hosted $(addprefix hal/ports/,$(call ports_of,hosted))
$(RESULTS)/lint/dependencies.check: FORCE
	$(check) $(VENV_PYTHON) scripts/lint/lint_dependencies.py
$(RESULTS)/lint/firmware.check: FORCE
	$(check) $(VENV_PYTHON) scripts/lint/lint_firmware.py

$(RESULTS)/lint/isr-calls.check $(RESULTS)/lint/size.check: $(LINKED:%=linked-%) FORCE
$(RESULTS)/lint/isr-calls.check:
	$(check) $(if $(LINKED),$(VENV_PYTHON) scripts/lint/lint_isr_calls.py $(WITH_FAMILY),$(NO_CROSS))
$(RESULTS)/lint/size.check:
	$(check) $(if $(LINKED),$(SIZE_TABLE) compare $(WITH_FAMILY),$(NO_CROSS))

$(RESULTS)/lint/ruff-check.check: FORCE
	$(check) .venv/bin/ruff check --config scripts/pyproject.toml $(PYTHON_FOLDERS)
$(RESULTS)/lint/ruff-format.check: FORCE
	$(check) .venv/bin/ruff format --check --diff --config scripts/pyproject.toml $(PYTHON_FOLDERS)
$(RESULTS)/lint/mypy.check: FORCE
	$(check) .venv/bin/mypy --config-file scripts/pyproject.toml --cache-dir build/mypy_cache \
	    $(PYTHON_FILES)
$(RESULTS)/lint/shellcheck.check: FORCE
	$(check) shellcheck $(SHELL_FILES)

$(RESULTS)/lint/licences.check: FORCE
	$(check) $(VENV_PYTHON) scripts/lint/sbom.py build/sbom.json $(SETUP_LOCKS)

.PHONY: analyzed
analyzed: $(call object_of,$(IN_LIBRARY) $(MAIN) $(HOSTED))

.PHONY: tidy
tidy: $(C_SOURCES:%=$(OUT)/tidy/%.ok)
$(OUT)/tidy/%.ok: % .clang-tidy $(OUT)/flags/$$(call room_of,$$*) $(C_HEADERS)
	@mkdir -p $(@D)
	@.venv/bin/clang-tidy --quiet $< -- $(filter-out -Werror $(EVERYTHING),$(call cflags_of,$<))
	@touch $@
