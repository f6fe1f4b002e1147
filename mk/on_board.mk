# What is built for boards, run on them and measured there. `boards/BOARD` is the variant.

# ---- the programs: firmware.elf of main.c, NAME.elf of main_NAME.c; the rest is a library -----------

MAINS  := $(filter %/main.c $(PORT_FOLDER)/main_%.c,$(PORT_SOURCES))
SECOND := $(patsubst $(PORT_FOLDER)/main_%.c,$(OUT)/%.elf,$(filter-out %/main.c,$(MAINS)))

$(OUT)/libboard.a: $(call object_of,$(filter-out $(MAINS),$(PORT_SOURCES)) $(FIRMWARE))
	@rm -f $@
	@ar rcs $@ $^

$(OUT)/firmware.elf: $(call object_of,$(filter %/main.c,$(MAINS)))
$(SECOND): $(OUT)/%.elf: $(call object_of,$(PORT_FOLDER)/main_%.c)
$(OUT)/firmware.elf $(SECOND): $(OUT)/libboard.a $(LINKER_SCRIPTS) $(wildcard $(PORT_FOLDER)/board.mk)
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LDFLAGS) $(filter %.o,$^) $(filter %.a,$^) -lm -o $@

# A build is the port compiled as a whole: the flags of its names change any of its files.
in_build = $(subst -, ,$*)
$(OUT)/firmware-%.elf: $(PORT_SOURCES) $(call headers_of,$(notdir $(PORT_FOLDERS))) $(wildcard $(PORT_FOLDER)/board.mk) \
                       $(LINKER_SCRIPTS) $(call object_of,$(FIRMWARE))
	$(SAY) 'link $@'
	$(Q)$(CC) $(filter-out -fstack-usage,$(FLAGS)) $(CFLAGS.hal) \
	    $(foreach name,$(in_build),$(DISTURBANCE.$(TARGET).$(name))) $(LDFLAGS) \
	    $(filter-out $(PORT_FOLDER)/main_%.c $(foreach folder,$(PORT_FOLDERS),$(LEFT_OUT.$(TARGET):%=$(folder)/%)), \
	        $(filter %.c %.o,$^)) -lm -o $@

.PHONY: linked-board board-programs
linked-board: $(OUT)/firmware.elf $(SECOND) $(OUT)/obj/tests/boards/one_of_each.o
	@:
board-programs: linked-board $(BUILDS.$(TARGET):%=$(OUT)/firmware-%.elf)
	@:

.PHONY: $(LINKED:%=linked-%) $(BOARDS:%=programs-%)
$(LINKED:%=linked-%): linked-%:
	@$(MAKE) VARIANT=boards/$* linked-board
$(BOARDS:%=programs-%): programs-%: linked-% $$(RIG_TOOLS.$$*)
	@$(MAKE) VARIANT=boards/$* board-programs

# Programs that run here beside a simulated AVR.
simavr_program = $(Q)gcc -O2 -std=c11 $(filter-out -Wcast-qual,$(WARNINGS)) \
                     -isystem /usr/include/simavr $(filter %.c,$^) -lsimavr -lelf -o $@
$(AVR_TEST_RUN): tests/boards/avr_test_run.c
	@mkdir -p $(@D)
	$(simavr_program)
build/rigs/%: hal/ports/%.c $$(wildcard hal/ports/$$*_*.[ch])
	@mkdir -p $(@D)
	$(simavr_program)

# ---- suites --------------------------------------------------------------------------------------

# The contract suites, and the unit tests of the firmware but for its mathematics, which wants a
# double of 64 bits and the memory of a PC.
OFF_BOARD   := host_sim/% hal/ports/% firmware/comp/% firmware/transmission/% firmware/cycle/kinematics% \
               firmware/cycle/sphere%
is_portable = $(if $(filter $(OFF_BOARD),$(LINK.$(1:.c=))),,$1)
ON_BOARD    := $(TESTS.contract) $(foreach test,$(filter tests/%,$(TESTS.unit)),$(call is_portable,$(test)))
# A board without pulse inputs leaves that header of the HAL out.
no_pulses   = $(if $(wildcard hal/ports/$1/pulse.c),,%/test_hal_pulse.c)
suites_on   = $(if $(CONTRACT_ONLY.$1),$(TESTS.contract),$(ON_BOARD))
names_on    = $(notdir $(basename $(filter-out $(call no_pulses,$1),$(call suites_on,$1))))
unsuited    = $(or $(UNSUITED.$1.$2),$(UNSUITED.$(FAMILY.$1).$2))
outcome_on  = $2.$(if $(call unsuited,$1,$2),check,log)
on_board    = $(foreach name,$(call names_on,$1),$(RESULTS)/target-$1/$(call outcome_on,$1,$(name)))
target_results = $(if $(call tools_of,$1),$(call on_board,$1),$(RESULTS)/target-$1/tools.check)
$(foreach board,$(BOARDS),$(eval RESULTS.target-$(board) := $(call target_results,$(board))))

.PHONY: $(ON_BOARDS:%=run-%) run-on-board
# What others link of the board is there before: two makes at once would write the same objects.
$(ON_BOARDS:%=run-%): run-target-%: generated \
                      $$(if $$(call runs_suites,$$*),$$(addprefix linked-,$$(filter $$*,$(LINKED)))) \
                      $$(if $$(filter avr,$$(FAMILY.$$*)),$$(if $$(TOOLS.avr),$(AVR_TEST_RUN)))
	@$(if $(call tools_of,$*),$(MAKE) VARIANT=boards/$* RESULTS=$(RESULTS) run-on-board,\
	    scripts/run_check.sh $(RESULTS)/target-$*/tools.check target-$* \
	    $(call skip,$(call no_tools_of,$*)))
run-on-board: $(if $(TARGET),$(call on_board,$(TARGET)))

SUITE_RUN = $(or $(SUITE_RUN.$(PORT)),$(SUITE_RUN.$(FAMILY)))
ifneq ($(TARGET),)
$(RESULTS)/target-$(TARGET)/%.log: $(OUT)/contract/% FORCE
	@tests/boards/run_suite.sh $(TARGET) $< $@ $(SUITE_RUN)
$(RESULTS)/target-$(TARGET)/%.log: $(OUT)/tests/unit/% FORCE
	@tests/boards/run_suite.sh $(TARGET) $< $@ $(SUITE_RUN)
$(RESULTS)/target-$(TARGET)/%.check: FORCE
	$(check) $(call skip,$(call unsuited,$(TARGET),$*))
endif

$(OUT)/contract/% $(OUT)/tests/unit/%: LDFLAGS += $(SUITE_LDFLAGS.$(FAMILY))
$(OUT)/contract/%: $(OUT)/obj/tests/contract/%.o $(OUT)/foreign/runners/tests/contract/%.o \
                   $(OUT)/foreign/unity.o \
                   $$(call object_of,$$(call under_test,$$*,$(PORT)) $(TARGET_GLUE)) \
                   $(OUT)/libboard.a $(LINKER_SCRIPTS)
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $(LDFLAGS) $(filter %.o,$^) $(filter %.a,$^) -lm -o $@

# ---- measuring: suites, sizes, and a campaign of each build ---------------------------------------

.PHONY: boards board a-board
boards: setup setup-test ## run the suites of all boards, measure them in their emulators, into build/boards
	$(call run_suites,$(ON_BOARDS) $(BOARDS:%=board-%))
board: a-board setup setup-test ## the same of one, BOARD=its folder in hal/ports; without that, list them
	$(call run_suites,target-$(BOARD) board-$(BOARD))
a-board:
	@$(if $(filter $(BOARDS),$(BOARD)),,echo 'make board BOARD=…: one of $(BOARDS)' >&2; exit 2)

measures_of     = size $(or $(if $(RIG.$1),$(BUILDS.$1)),touches) $(if $(MEASURE.$1),measure)
measures_result = $(patsubst %,$(RESULTS)/board-$1/%.check,$(if $(call tools_of,$1),$(call measures_of,$1),tools))
$(foreach board,$(BOARDS),$(eval RESULTS.board-$(board) := $(call measures_result,$(board))))

.PHONY: $(BOARDS:%=run-board-%) measure-board
$(BOARDS:%=run-board-%): run-board-%: generated $$(addprefix linked-,$$(filter $$*,$(LINKED))) \
                         $$(if $$(call tools_of,$$*),$$(RIG_TOOLS.$$*))
	@$(if $(call tools_of,$*),$(MAKE) VARIANT=boards/$* RESULTS=$(RESULTS) measure-board,\
	    scripts/run_check.sh $(RESULTS)/board-$*/tools.check board-$* \
	    $(call skip,$(call no_tools_of,$*)))
measure-board: $(if $(TARGET),$(RESULTS.board-$(TARGET)))

# What was measured is shown as well, under its outcome.
measured = @scripts/run_check.sh $@ '$(TARGET), $*' $1 && sed 's/^/    /' $@.out
ifneq ($(TARGET),)
$(RESULTS)/board-$(TARGET)/%.check: campaign = $(OUT)/campaigns/$*
$(RESULTS)/board-$(TARGET)/%.check: touches  = $(or $(TOUCHES),$(TOUCHES.$(TARGET).$*),$(TOUCHES.$(TARGET)),2000)
$(RESULTS)/board-$(TARGET)/%.check: $(OUT)/firmware-%.elf FORCE
	@rm -rf $(campaign)
	$(call measured,$(VENV_PYTHON) -m $(RIG.$(TARGET)) $< --out $(campaign) --touches $(touches) \
	    $(RIG_OPTIONS.$(TARGET).$*))
$(addprefix $(RESULTS)/board-$(TARGET)/,size.check measure.check touches.check): \
        $(RESULTS)/board-$(TARGET)/%.check: linked-board FORCE
	$(call measured,$(MEASURE_BY.$*))
endif
MEASURE_BY.size    = $(SIZE_TABLE) compare $(TARGET):$(FAMILY)
MEASURE_BY.measure = $(MEASURE.$(TARGET))
MEASURE_BY.touches = $(call skip,no RIG in its board.mk)

# ---- sizes ---------------------------------------------------------------------------------------

WITH_FAMILY := $(foreach board,$(LINKED),$(board):$(FAMILY.$(board)))
NO_CROSS     = $(call skip,no cross compilers here: scripts/setup/system.sh cross)
SIZE_TABLE  := $(VENV_PYTHON) scripts/lint/size_table.py
.PHONY: size
size: setup-lint ## flash, RAM, worst stack of each board beside the record; RECORD=yes keeps them
	@$(INNER_MAKE) $(LINKED:%=linked-%)
	@$(SIZE_TABLE) $(if $(RECORD),record,compare) $(WITH_FAMILY)
