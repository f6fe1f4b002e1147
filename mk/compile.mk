# Objects, libraries and the programs that run here.

.PHONY: library program objects
library: $(OUT)/libskiplatch_sim.so
	@:
program: $(if $(MAIN),$(OUT)/skiplatch-sim) $(HOSTED_PROGRAMS)
	@:
OTHERS   := $(SIM) $(DIAGNOSIS) $(MAIN) $(UNHOSTED) $(HOSTED) $(TESTS) $(FUZZ) $(PERF) $(SOAK) $(HOSTED_RIG)
objects: $(call object_of,$(FIRMWARE) $(if $(TARGET),$(PORT_SOURCES),$(OTHERS))) \
         $(patsubst %,$(OUT)/headers/%.ok,$(if $(TARGET),$(call headers_of,$(notdir $(PORT_FOLDERS))),$(C_HEADERS)))

$(OUT)/obj/%.o: %.c $(OUT)/flags/$$(call room_of,$$*.c)
	@mkdir -p $(@D)
	$(SAY) '$(CC) $<'
	$(Q)$(CC) $(call cflags_of,$<) $(TEST_CFLAGS) -MMD -MP -c $< -o $@

$(OUT)/foreign/%.o: build/%.c $(OUT)/flags/foreign
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $(CFLAGS.foreign) -MMD -MP -c $< -o $@

$(OUT)/foreign/unity.o: $(UNITY)/src/unity.c $(OUT)/flags/foreign
$(OUT)/foreign/cmock.o: $(CMOCK)/src/cmock.c $(OUT)/flags/foreign
$(OUT)/foreign/unity.o $(OUT)/foreign/cmock.o:
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $(CFLAGS.foreign) -c $< -o $@

# A header has to compile on its own.
$(OUT)/headers/%.ok: % $(OUT)/flags/$$(call room_of,$$*)
	@mkdir -p $(@D)
	@echo '#include "$<"' >$@.c && echo 'typedef int not_empty_t;' >>$@.c
	$(Q)$(CC) $(filter-out -fstack-usage,$(call cflags_of,$<)) -I. -fsyntax-only -MMD -MP -MT $@ -MF $@.d $@.c && touch $@

$(OUT)/libskiplatch_sim.so: $(call object_of,$(IN_LIBRARY))
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) -shared -Wl,-z,defs $^ -lm -o $@.new && mv $@.new $@

$(OUT)/libskiplatch_sim.a: $(call object_of,$(IN_LIBRARY))
	@rm -f $@
	@ar rcs $@ $^

$(OUT)/skiplatch-sim: $(call object_of,$(MAIN)) $(OUT)/libskiplatch_sim.a
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) $^ -lm -o $@

# The C codec of the injection protocol as a program, for the tests that compare it with the DBC.
CODEC := tests/support/inject_codec.c $(wildcard firmware/inject/*.c) firmware/report/latch_frame.c \
         firmware/report/latch_crc.c
$(OUT)/inject-codec: $(call object_of,$(CODEC))
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ -o $@

# A port of the family host is linked, with all the firmware; nothing runs it.
$(HOST_PORTS:%=$(OUT)/ports/%): $(OUT)/ports/%: \
        $$(call object_of,$$(wildcard hal/ports/$$*/*.c)) $(call object_of,$(FIRMWARE))
	@mkdir -p $(@D)
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ -lm -o $@

# ---- for editors and clangd ----------------------------------------------------------------------

json_text  = $(subst ",\",$(subst \,\\,$1))
command_of = { "directory": "$(CURDIR)", "file": "$1", "command": "$(call json_text,$(CC) $(call cflags_of,$1)) -c $1" }
COMMANDED := $(if $(TARGET),$(PORT_SOURCES),$(IN_LIBRARY) $(MAIN) $(UNHOSTED) $(HOSTED) $(TESTS))
.PHONY: commands
commands:
	@printf ',%s\n' $(foreach source,$(COMMANDED),$(call quoted,$(call command_of,$(source))))

compile_commands.json: Makefile $(wildcard mk/*.mk hal/ports/*/board.mk) $(sort $(dir $(COMMANDED)))
	@{ echo '['; for variant in host $(BOARDS:%=boards/%); do \
	    $(MAKE) --silent INNER=yes VARIANT=$$variant commands || exit 1; \
	done | sed '1s/^,//'; echo ']'; } >$@
