# Fuzzing: a target links like a test. libFuzzer brings main(), or fuzz_replay.c, which runs the seeds.

define fuzz_rules
$(OUT)/replay/$(notdir $1): $(call object_of,$1.c tests/support/fuzz_replay.c) $(parts_of)
$(OUT)/fuzz/$(notdir $1): $(call object_of,$1.c) $(parts_of)
$(if $(CFLAGS.$1),$(call private_rules,$1))
endef
$(foreach target,$(FUZZ:.c=),$(eval $(call fuzz_rules,$(target))))

$(OUT)/replay/%:
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $^ -lm -o $@

$(OUT)/fuzz/fuzz_%:
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) -fsanitize=fuzzer $^ -lm -o $@

# Without Atheris the parsers in Python are fuzzed blindly.
$(STAMPS)/fuzz: scripts/requirements-fuzz.lock $(VENV)
	@mkdir -p $(@D)
	@$(VENV_PYTHON) -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement $< && touch $@ || echo 'SKIPPED: no Atheris to be had here'

SECONDS ?= 60
.PHONY: fuzz
fuzz: setup setup-lint $(STAMPS)/fuzz ## run every fuzz target, and each reader of files in Python, for SECONDS=60 from its seeds
	@$(MAKE) VARIANT=fuzz INNER=yes $(addprefix fuzz/,$(notdir $(basename $(FUZZ) $(FUZZ_PYTHON))))

.PHONY: $(addprefix fuzz/,$(notdir $(basename $(FUZZ) $(FUZZ_PYTHON))))
$(FUZZ:tests/fuzz/%.c=fuzz/%): fuzz/fuzz_%: $(OUT)/fuzz/fuzz_%
	@mkdir -p $(OUT)/corpus/$* $(OUT)/findings
	$< -max_total_time=$(SECONDS) -print_final_stats=1 -artifact_prefix=$(OUT)/findings/$*- \
	    $(OUT)/corpus/$* $(wildcard tests/fuzz/corpus/$*)

$(FUZZ_PYTHON:tests/fuzz/%.py=fuzz/%): fuzz/%: tests/fuzz/%.py
	$(VENV_PYTHON) $< $(SECONDS)

.PHONY: run-fuzz-regression run-replay
run-fuzz-regression:
	@$(if $(FUZZ),$(MAKE) VARIANT=sanitize RESULTS=$(RESULTS) run-replay)
run-replay: $(RESULTS.fuzz-regression)
$(RESULTS)/fuzz-regression/%.check: $(OUT)/replay/% FORCE
	$(check) $< $(wildcard tests/fuzz/corpus/$(*:fuzz_%=%)/*)
