# Touches, restarts, wraps and a bad bus at random, for as long as it is let.

HOURS     ?= 0.1
SOAK_SEED ?= $(shell date +%s)
$(OUT)/soak: $(call object_of,$(SOAK) tests/support/dice.c) $(OUT)/libskiplatch_sim.a
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) $^ -lm -o $@

.PHONY: soak
soak: setup ## play touches over a bad bus with restarts and power cuts for HOURS=0.1, and account for each record
	@$(INNER_MAKE) $(OUT)/soak
	@nice $(OUT)/soak $$(awk 'BEGIN { print 3600 * $(HOURS) }') $(SOAK_SEED)
