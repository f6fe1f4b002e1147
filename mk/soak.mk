# Touches, restarts, wraps and a bad bus at random, for as long as it is let: here, and on each board
# that knows how, one after the other.

HOURS     ?= 0.1
SOAK_SEED := $(or $(SOAK_SEED),$(shell date +%s))
SOAK_S     = $$(awk 'BEGIN { print 3600 * $(HOURS) }')
SOAKED    := $(foreach board,$(BOARDS),$(if $(SOAK.$(board)),$(board)))
$(OUT)/soak: $(call object_of,$(SOAK) tests/support/dice.c) $(OUT)/libskiplatch_sim.a
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) $^ -lm -o $@

.PHONY: soak $(SOAKED:%=soak-%)
soak: setup ## play touches over a bad bus with restarts and power cuts for HOURS=0.1, on each board too, and account for each record
	@$(INNER_MAKE) $(OUT)/soak
	@nice $(OUT)/soak $(SOAK_S) $(SOAK_SEED)
	@$(MAKE) $(SOAKED:%=soak-%) SOAK_SEED=$(SOAK_SEED)
$(SOAKED:%=soak-%): soak-%:
	@$(if $(call tools_of,$*),$(INNER_MAKE) programs-$*,echo 'soak on $*: SKIPPED, $(call no_tools_of,$*)')
	@$(if $(call tools_of,$*),nice $(VENV_PYTHON) -m $(SOAK.$*) $(SOAK_S) $(SOAK_SEED))
