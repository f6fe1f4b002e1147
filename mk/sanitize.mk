# Sanitizers: all C tests for addresses and undefined behaviour, those of the kinematics for reads of
# what was never written.

RESULTS.sanitize := $(RESULTS)/sanitize/address.check $(RESULTS)/sanitize/memory.check

.PHONY: sanitize run-sanitize
sanitize: setup-lint ## run the C tests under address, undefined-behaviour and memory sanitizers
	@$(INNER_MAKE) generated
	$(call run_suites,$@)
run-sanitize: $(RESULTS.sanitize)
	@:
$(RESULTS)/sanitize/address.check: FORCE
	$(check) $(MAKE) VARIANT=sanitize c-tests
$(RESULTS)/sanitize/memory.check: FORCE
	$(check) $(MAKE) VARIANT=memory counted SUITES=unit
