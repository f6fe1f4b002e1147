# skiplatch: set-up, build, tests and checks. `make help` lists what there is to call.
#
# Everything lands in build/ and .venv/. What is called by hand runs in order; the compiling and the
# checking behind it run in a second make (the INNER one), on all processors.
#
# A C test says at its top what it is made of:
#
#   /* LINK: firmware/input/latch.c tests/support/edges.c */   sources, * allowed; without this line
#                                                              a contract or scenario test gets all
#   /* MOCK: hal/include/hal_edge.h */                         headers CMock makes mock_….h of
#   /* CFLAGS: -DLATCH_STEP=hook */                            for the test and what it links

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SECONDARY:
.SECONDEXPANSION:
MAKEFLAGS += --no-builtin-rules --no-builtin-variables --no-print-directory
ifndef INNER
.NOTPARALLEL:
endif

# make V=1 shows the commands themselves.
SAY := $(if $(V),@:,@echo)
Q   := $(if $(V),,@)

# ---- variants: one tree of objects for each way to compile ---------------------------------------

# host      what setup, test and demo use          avr, arm  firmware and ports, compiled only
# sanitize  address and undefined-behaviour checks gcc, clang  everything, compiled only
# coverage  counts what the tests reach            fuzz      libFuzzer
# boards/BOARD  firmware, port and suites for that board
VARIANT ?= host
OUT     := build/$(VARIANT)

BOARDS            := atmega328p atmega2560 cortex_m3
FAMILY.atmega328p := avr
FAMILY.atmega2560 := avr
FAMILY.cortex_m3  := arm
# The same port for other cores, to keep it portable.
FAMILY.cortex_m0plus := arm
FAMILY.cortex_m4f    := arm
PORT.cortex_m0plus   := cortex_m3
PORT.cortex_m4f      := cortex_m3
BOARD             := $(patsubst boards/%,%,$(filter boards/%,$(VARIANT)))
FAMILY            := $(FAMILY.$(BOARD))
PORT              := $(or $(PORT.$(BOARD)),$(BOARD))

CC.host     := gcc
CC.gcc      := gcc
CC.sanitize := gcc
CC.coverage := gcc
CC.clang    := clang
CC.fuzz     := clang
CC.avr      := avr-gcc
CC.arm      := arm-none-eabi-gcc
CC.avr-board := avr-gcc
CC.arm-board := arm-none-eabi-gcc
CC          := $(or $(CC.$(VARIANT)),$(CC.$(FAMILY)-board))

SANITIZERS := -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
# Nobody looks at errno or at floating-point traps after a sum.
FLAGS.host     := -O3 -g -fno-math-errno -fno-trapping-math
FLAGS.gcc      := -O2
FLAGS.clang    := -O1
FLAGS.sanitize := -O1 -g $(SANITIZERS)
FLAGS.coverage := -O0 -g --coverage -fprofile-update=atomic
FLAGS.fuzz     := -O1 -g $(SANITIZERS) -fsanitize=fuzzer-no-link
FLAGS.avr      := -Os -mmcu=atmega328p
FLAGS.arm      := -Os -mcpu=cortex-m3 -mthumb
FLAGS.boards/atmega328p := -mmcu=atmega328p
FLAGS.boards/atmega2560 := -mmcu=atmega2560
FLAGS.boards/cortex_m3  := -mcpu=cortex-m3 -mthumb
FLAGS.boards/cortex_m0plus := -mcpu=cortex-m0plus -mthumb
FLAGS.boards/cortex_m4f    := -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard
FLAGS.boards            := -Os -g -ffunction-sections -fdata-sections -fstack-usage -Wl,--gc-sections
LDFLAGS.arm-board := --specs=nano.specs -nostartfiles -T hal/ports/cortex_m3/lm3s6965.ld
LDFLAGS           := $(LDFLAGS.$(FAMILY)-board)
CROSS          := $(filter avr arm boards/%,$(VARIANT))

# Contracted multiply-adds would make figures depend on the processor.
FLAGS := $(FLAGS.$(VARIANT)) $(if $(BOARD),$(FLAGS.boards)) $(if $(CROSS),,-fPIC -fvisibility=hidden -pthread -ffp-contract=off)

WARNINGS := -Wall -Wextra -Wpedantic -Werror -Wcast-align -Wcast-qual -Wconversion -Wfloat-equal \
            -Wformat=2 -Wmissing-prototypes -Wpointer-arith -Wshadow -Wsign-conversion \
            -Wstrict-prototypes -Wundef -Wvla -Wwrite-strings
# What clang and the old compiler for the AVR do not know.
ifneq ($(filter host gcc arm,$(VARIANT)),)
WARNINGS += -Wduplicated-branches -Wduplicated-cond -Wlogical-op -Wnull-dereference
endif
# Instrumented code draws warnings that the plain one does not deserve.
ifneq ($(filter sanitize coverage fuzz,$(VARIANT)),)
WARNINGS := -w
endif

CMOCK := /usr/share/cmock
UNITY := $(CMOCK)/vendor/unity

INCLUDES        := -Ifirmware -Ihal/include -Ihost_sim
CFLAGS.firmware := -std=c99 $(WARNINGS) -Wdouble-promotion $(INCLUDES)
CFLAGS.hal      := $(CFLAGS.firmware)
CFLAGS.host_sim := -std=c11 -D_GNU_SOURCE $(WARNINGS) $(INCLUDES)
# Unity compares floating-point numbers and calls test functions that have no prototype.
CFLAGS.tests    := -std=c11 -D_GNU_SOURCE $(WARNINGS) -Wno-missing-prototypes -Wno-float-equal \
                   $(INCLUDES) -Itests -Itests/support -Ibuild/mocks \
                   -DUNITY_INCLUDE_DOUBLE -isystem $(UNITY)/src -isystem $(CMOCK)/src
# Optimizing the library as a whole makes it faster by a third; tests link the plain code beside it.
ifeq ($(VARIANT),host)
CFLAGS.firmware += -flto -ffat-lto-objects
CFLAGS.host_sim += -flto -ffat-lto-objects
LTO             := -flto=auto
endif
# What CMock and Unity wrote is not ours to mend.
CFLAGS.foreign  := -std=c11 -w $(INCLUDES) -Itests/support -Ibuild/mocks \
                   -DUNITY_INCLUDE_DOUBLE -I$(UNITY)/src -I$(CMOCK)/src

# A suite on a board speaks and ends through tests/support/target.h.
ifneq ($(BOARD),)
TARGET_UNITY   := -Itests/support -include target.h -DUNITY_OUTPUT_CHAR=target_put_char \
                  '-DUNITY_OUTPUT_CHAR_HEADER_DECLARATION=target_put_char(char)' \
                  -DUNITY_OUTPUT_COMPLETE=target_done -DUNITY_SUPPORT_64 -DCMOCK_MEM_SIZE=4096
# The old compiler for the AVR warns of conversions that were asked for.
CFLAGS.tests   += $(TARGET_UNITY) $(if $(filter avr,$(FAMILY)),-Wno-conversion -Wno-sign-conversion)
CFLAGS.foreign += $(TARGET_UNITY)
endif

# libgpiod 2 of the system, or the one that setup_gpiod.sh has unpacked aside; without it there is no
# Linux port.
GPIOD_SYSTEM := $(shell grep -ls gpiod_chip_request_lines /usr/include/gpiod.h)
GPIOD_ASIDE  := $(if $(GPIOD_SYSTEM),,$(wildcard build/gpiod/usr/include/gpiod.h))
GPIOD_LIB    := $(if $(GPIOD_SYSTEM),-lgpiod,$(wildcard build/gpiod/usr/lib/*/libgpiod.a))
CFLAGS.linux := $(filter-out -std=c99 -flto -ffat-lto-objects,$(CFLAGS.hal)) -std=c11 -D_GNU_SOURCE \
                $(if $(GPIOD_ASIDE),-isystem build/gpiod/usr/include)

# $(call cflags_of,path/in/the/tree.c): the flags of the room the file stands in.
room_of   = $(if $(filter hal/ports/linux/%,$1),linux,$(firstword $(subst /, ,$1)))
cflags_of = $(FLAGS) $(CFLAGS.$(room_of)) $(shown)

# ---- sources -------------------------------------------------------------------------------------

FIRMWARE := $(wildcard firmware/*/*.c)
SIM      := $(wildcard host_sim/*.c host_sim/effects/*.c)
MAIN     := $(wildcard host_sim/programs/main.c)
PROGRAMS := $(filter-out $(MAIN),$(wildcard host_sim/programs/*.c))
TEMPLATE := $(wildcard hal/ports/template/*.c)
LINUX    := $(if $(GPIOD_LIB),$(wildcard hal/ports/linux/*.c))
INJECTOR := $(filter hal/ports/linux/injector%,$(LINUX))
RECORDER := $(filter hal/ports/linux/recorder%,$(LINUX))
CONTROL  := $(filter hal/ports/linux/main.c hal/ports/linux/options.c,$(LINUX))
PORTS.avr := $(wildcard hal/ports/atmega328p/*.c)
PORTS.arm := $(wildcard hal/ports/cortex_m3/*.c)
PORTS.boards/$(BOARD) := $(wildcard hal/ports/$(PORT)/*.c)
# The programs of a port, the second one where it has that; the rest of it is a library.
MAINS      := %/main.c %/main_transmission.c
HAS_SECOND := $(filter %/main_transmission.c,$(PORTS.boards/$(BOARD)))
TARGET    := $(if $(BOARD),$(wildcard tests/support/target_$(FAMILY).c))

TESTS.unit     := $(wildcard tests/unit/test_*.c)
TESTS.contract := $(wildcard tests/contract/test_*.c)
TESTS.scenario := $(wildcard tests/scenario/test_*.c)
TESTS          := $(TESTS.unit) $(TESTS.contract) $(TESTS.scenario)
FUZZ           := $(wildcard tests/fuzz/fuzz_*.c)
FUZZ_PYTHON    := $(wildcard tests/fuzz/fuzz_*.py)
PERF           := $(wildcard tests/perf/*.c)
RIG            := $(if $(LINUX),$(wildcard tests/bench/*.c))

C_SOURCES := $(FIRMWARE) $(SIM) $(MAIN) $(PROGRAMS) $(TEMPLATE) $(LINUX)
C_HEADERS := $(wildcard firmware/*/*.h hal/include/*.h hal/ports/*/*.h host_sim/*.h host_sim/*/*.h)
C_HEADERS := $(if $(LINUX),$(C_HEADERS),$(filter-out hal/ports/linux/%,$(C_HEADERS)))
# Its registers are avr-libc's.
C_HEADERS := $(filter-out hal/ports/atmega328p/%,$(C_HEADERS))
C_FILES   := $(sort $(C_SOURCES) $(C_HEADERS) $(wildcard hal/ports/*/*.[ch] tests/*/*.[ch]))
PYTHON_FOLDERS := scripts $(wildcard tests)
PYTHON_FILES   := $(wildcard scripts/skiplatch) \
                  $(wildcard scripts/*.py tests/python/*.py tests/fuzz/*.py tests/perf/*.py \
                             tests/gap/*.py tests/bench/*.py tests/boards/*.py)
SHELL_FILES    := $(wildcard scripts/*.sh tests/*/*.sh) .ci/run

object_of = $(patsubst %.c,$(OUT)/obj/%.o,$1)

# ---- set-up --------------------------------------------------------------------------------------

STAMPS      := build/stamps
VENV_PYTHON := .venv/bin/python
VENV        := .venv/skiplatch.key

$(STAMPS)/system-%: scripts/setup_system.sh
	@scripts/setup_system.sh $*
	@mkdir -p $(@D) && touch $@

$(STAMPS)/cmock: scripts/setup_cmock.sh
	@scripts/setup_cmock.sh
	@mkdir -p $(@D) && touch $@

$(STAMPS)/gpiod: scripts/setup_gpiod.sh
	@scripts/setup_gpiod.sh
	@mkdir -p $(@D) && touch $@

# What needs an absent cross compiler, emulator or tool of the rig is counted as skipped.
$(addprefix $(STAMPS)/system-,cross emulators rig): $(STAMPS)/system-%: scripts/setup_system.sh
	@scripts/setup_system.sh $* || echo 'SKIPPED: no packages of the group $* to be had here'
	@mkdir -p $(@D) && touch $@

$(VENV): scripts/setup_python.sh scripts/requirements.lock scripts/pyproject.toml \
         | $(STAMPS)/system-build
	@scripts/setup_python.sh

.PHONY: setup-build setup-test setup-lint
setup-build: $(STAMPS)/system-build $(STAMPS)/gpiod $(VENV)
setup-test: setup-build $(STAMPS)/system-test $(STAMPS)/cmock \
            $(STAMPS)/system-cross $(STAMPS)/system-emulators
setup-lint: setup-test $(STAMPS)/system-lint $(STAMPS)/system-cross

# Without the general tool that the diagnosis is compared with, the rest of the benchmark still runs.
$(STAMPS)/bench: scripts/requirements-bench.lock $(VENV)
	@mkdir -p $(@D)
	@$(VENV_PYTHON) -m pip install --quiet --disable-pip-version-check --require-hashes \
	    --requirement $< && touch $@ || echo 'SKIPPED: no pyABC to be had here'

# ---- what is called by hand ----------------------------------------------------------------------

# On all processors, unless the caller has said how many with -j.
JOBS        = $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$(shell nproc))
INNER_MAKE  = $(MAKE) INNER=yes --keep-going $(JOBS)
RESULTS    ?= $(if $(filter host,$(VARIANT)),build,$(OUT))/results

C_SUITES    := unit contract scenario
ON_BOARDS   := $(BOARDS:%=target-%)
TEST_SUITES := $(C_SUITES) template contract-linux $(ON_BOARDS) fuzz-regression python

# Every result first becomes an empty file: what does not build or run is then counted as failed.
define run_suites
	@rm -rf $(addprefix $(RESULTS)/,$1) && mkdir -p $(addprefix $(RESULTS)/,$1)
	@touch $(RESULTS)/.declared $(foreach suite,$1,$(RESULTS.$(suite)))
	-@$(INNER_MAKE) $(addprefix run-,$1)
	@$(VENV_PYTHON) scripts/count_tests.py $(RESULTS) $1
endef

.PHONY: help
help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  %-12s %s\n", $$1, $$2 }' Makefile

.PHONY: setup
setup: setup-build ## install what is missing, make .venv and the simulator's library
	@$(INNER_MAKE) library program

.PHONY: demo
demo: setup ## set up and run a small campaign into build/demo
	@.venv/bin/skiplatch demo --out build/demo

.PHONY: test
test: setup setup-test ## set up and run every test but the long ones
	$(call run_suites,$(TEST_SUITES))

.PHONY: long
long: setup setup-test ## run the tests that take long: whole diagnoses of two effects, and of the rig
	$(call run_suites,$@)

.PHONY: $(TEST_SUITES)
$(TEST_SUITES): setup setup-test # one suite alone, e.g. make unit
	$(call run_suites,$@)

.PHONY: lint
lint: setup-lint ## set up and run every static check
	@$(INNER_MAKE) generated
	$(call run_suites,lint)

.PHONY: c-tests
c-tests:
	$(call run_suites,$(C_SUITES))

.PHONY: sanitize
sanitize: setup-test ## run the C tests under address and undefined-behaviour sanitizers
	@$(MAKE) VARIANT=sanitize c-tests

COVERAGE         := $(VENV_PYTHON) -m coverage
COVERAGE_OPTIONS := --rcfile=scripts/pyproject.toml --data-file=build/coverage/python
.PHONY: coverage
coverage: setup setup-test ## run all tests and report what they reach, in build/coverage/report
	@rm -rf build/coverage/report && mkdir -p build/coverage/report/c
	@find build/coverage -name '*.gcda' -delete
	@$(INNER_MAKE) VARIANT=coverage library
	-@$(MAKE) VARIANT=coverage c-tests
	@.venv/bin/gcovr --root . --object-directory build/coverage \
	    --filter firmware/ --filter host_sim/ --print-summary \
	    --txt build/coverage/report/c.txt --html-details build/coverage/report/c/index.html
	-@$(COVERAGE) run $(COVERAGE_OPTIONS) -m pytest $(PYTEST_OPTIONS) --quiet tests/python
	@$(COVERAGE) report $(COVERAGE_OPTIONS) | tee build/coverage/report/python.txt

.PHONY: bench
bench: setup $(STAMPS)/bench $(STAMPS)/system-rig ## measure speed
	@$(INNER_MAKE) $(if $(PERF),build/perf/libfloor.so) $(if $(LINUX),$(RIG:%.c=$(OUT)/%)) program
	@$(VENV_PYTHON) tests/perf/bench.py
	@$(VENV_PYTHON) -m tests.bench.latency

# The suites of the rig, one in the virtual machine and one on this host's own vcan and gpio-sim.
RIG_SUITES := bench-vm bench-host
.PHONY: bench-vm
bench-vm: setup setup-test ## test the Linux port in a virtual machine with CAN and GPIO, and time it
	$(call run_suites,$@)

.PHONY: bench-host
bench-host: setup setup-test ## the same on this host, as root, with vcan and gpio-sim
	$(call run_suites,$@)

COUNT        ?= 20
SEED         ?= 1
FALSE_ALARMS ?= 0
TIES         ?= 0
PLANTED      ?= 0
.PHONY: gap-check
gap-check: setup ## diagnose COUNT=20 campaigns whose effects are sealed, and score that
	@$(VENV_PYTHON) -m tests.gap.check --count $(COUNT) --seed $(SEED) --jobs $(shell nproc) \
	    --false-alarms $(FALSE_ALARMS) $(OPTIONS)
	$(if $(filter-out 0,$(TIES)),@$(VENV_PYTHON) -m tests.gap.ties --count $(TIES) \
	    --seed $(SEED) --jobs $(shell nproc))
	$(if $(filter-out 0,$(PLANTED)),@$(VENV_PYTHON) -m tests.gap.planted --count $(PLANTED) \
	    --seed $(SEED) --jobs $(shell nproc))

SECONDS ?= 60
.PHONY: fuzz
fuzz: setup setup-lint ## run every fuzz target for SECONDS=60 from its seeds
	@$(MAKE) VARIANT=fuzz INNER=yes $(addprefix fuzz/,$(notdir $(basename $(FUZZ) $(FUZZ_PYTHON))))

# The boards that are measured in an emulator here, each with every build of DISTURBANCES.
MEASURED := atmega328p cortex_m3
.PHONY: boards
boards: setup setup-test $(STAMPS)/system-cross $(STAMPS)/system-emulators ## measure the boards in their emulators, into build/boards
	@$(INNER_MAKE) $(MEASURED:%=campaigns-%)

.PHONY: $(MEASURED:%=campaigns-%) $(MEASURED:%=programs-%) campaigns board-programs transmission
$(MEASURED:%=programs-%): programs-%:
	@$(MAKE) VARIANT=boards/$* board-programs
$(MEASURED:%=campaigns-%): campaigns-%:
	@$(if $(TOOLS.$(FAMILY.$*)),$(MAKE) VARIANT=boards/$* campaigns,\
	    echo "SKIPPED: $*: $(NO_TOOLS.$(FAMILY.$*))")

# The boards that can be linked here; those without an emulator are for the figures alone.
LINKED      := $(foreach board,$(BOARDS) cortex_m0plus cortex_m4f,\
                 $(if $(shell command -v $(CC.$(FAMILY.$(board))-board)),$(board)))
WITH_FAMILY := $(foreach board,$(LINKED),$(board):$(FAMILY.$(board)))
NO_CROSS     = $(call skip,no cross compilers here: scripts/setup_system.sh cross)
SIZE_TABLE  := $(VENV_PYTHON) scripts/size_table.py
.PHONY: size
size: setup-lint ## flash, RAM, worst stack of each board beside the record; RECORD=yes keeps them
	@$(INNER_MAKE) $(LINKED:%=linked-%)
	@$(SIZE_TABLE) $(if $(RECORD),record,compare) $(WITH_FAMILY)

.PHONY: $(LINKED:%=linked-%)
$(LINKED:%=linked-%): linked-%:
	@$(MAKE) VARIANT=boards/$* linked-board

.PHONY: format
format: setup-build ## lay out C and Python files as lint wants them
	@$(if $(C_FILES),.venv/bin/clang-format -i $(C_FILES))
	@.venv/bin/ruff check --quiet --config scripts/pyproject.toml --select I --fix $(PYTHON_FOLDERS)
	@.venv/bin/ruff format --config scripts/pyproject.toml $(PYTHON_FOLDERS)

.PHONY: totals
totals:
	@python3 scripts/count_tests.py $(RESULTS) $(TEST_SUITES) long lint \
	    $(notdir $(wildcard $(RESULTS)/bench-vm))

.PHONY: clean
clean: ## remove what was built
	rm -rf build

.PHONY: distclean
distclean: clean ## remove .venv as well
	rm -rf .venv scripts/*.egg-info

# ---- compiling -----------------------------------------------------------------------------------

.PHONY: library program objects generated linked-board FORCE
linked-board: $(OUT)/firmware.elf $(OUT)/obj/tests/boards/one_of_each.o \
              $(if $(HAS_SECOND),$(OUT)/transmission.elf)
	@:
library: $(OUT)/libskiplatch_sim.so
	@:
program: $(if $(MAIN),$(OUT)/skiplatch-sim) $(if $(LINUX),$(OUT)/skiplatch-controller) \
         $(if $(INJECTOR),$(OUT)/skiplatch-injector) $(if $(RECORDER),$(OUT)/skiplatch-recorder)
	@:
objects: $(call object_of,$(FIRMWARE) $(TEMPLATE) $(PORTS.$(VARIANT)))
ifndef CROSS
objects: $(call object_of,$(SIM) $(PROGRAMS) $(MAIN) $(LINUX) $(TESTS) $(FUZZ) $(PERF) $(RIG)) \
         $(C_HEADERS:%=$(OUT)/headers/%.ok)
endif

# Python calls this mathematics as it stands, so the shared library shows it.
SHOWN := firmware/comp/% firmware/cycle/overtravel.c
shown  = $(if $(filter $(SHOWN),$1),-fvisibility=default)

$(OUT)/obj/%.o: %.c Makefile
	@mkdir -p $(@D)
	$(SAY) '$(CC) $<'
	$(Q)$(CC) $(call cflags_of,$<) $(TEST_CFLAGS) -MMD -MP -c $< -o $@

$(OUT)/foreign/%.o: build/%.c Makefile
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $(CFLAGS.foreign) -MMD -MP -c $< -o $@

$(OUT)/foreign/unity.o: $(UNITY)/src/unity.c Makefile
$(OUT)/foreign/cmock.o: $(CMOCK)/src/cmock.c Makefile
$(OUT)/foreign/unity.o $(OUT)/foreign/cmock.o:
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $(CFLAGS.foreign) -c $< -o $@

# A header has to compile on its own.
$(OUT)/headers/%.ok: % Makefile
	@mkdir -p $(@D)
	@echo '#include "$<"' >$@.c && echo 'typedef int not_empty_t;' >>$@.c
	$(Q)$(CC) $(call cflags_of,$<) -I. -fsyntax-only -MMD -MP -MT $@ -MF $@.d $@.c && touch $@

$(OUT)/libskiplatch_sim.so: $(call object_of,$(FIRMWARE) $(SIM) $(PROGRAMS))
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) -shared -Wl,-z,defs $^ -lm -o $@.new && mv $@.new $@

$(OUT)/libskiplatch_sim.a: $(call object_of,$(FIRMWARE) $(SIM) $(PROGRAMS))
	@rm -f $@
	@ar rcs $@ $^

$(OUT)/skiplatch-sim: $(call object_of,$(MAIN)) $(OUT)/libskiplatch_sim.a
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) $^ -lm -o $@

$(OUT)/liblinux_port.a: $(call object_of,$(filter-out $(CONTROL) $(INJECTOR) $(RECORDER),$(LINUX)) $(FIRMWARE))
	@rm -f $@
	@ar rcs $@ $^

$(OUT)/skiplatch-controller: $(call object_of,$(CONTROL)) $(OUT)/liblinux_port.a
$(OUT)/skiplatch-injector: $(call object_of,$(INJECTOR)) $(OUT)/liblinux_port.a
$(OUT)/skiplatch-recorder: $(call object_of,$(RECORDER)) $(OUT)/liblinux_port.a
$(OUT)/skiplatch-controller $(OUT)/skiplatch-injector $(OUT)/skiplatch-recorder:
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ $(GPIOD_LIB) -lm -o $@

# The C codec of the injection protocol as a program, for the tests that compare it with the DBC.
CODEC := tests/support/inject_codec.c $(wildcard firmware/inject/*.c) firmware/report/latch_frame.c \
         firmware/report/latch_crc.c
$(OUT)/inject-codec: $(call object_of,$(CODEC))
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ -o $@

$(OUT)/template: $(call object_of,$(TEMPLATE) $(FIRMWARE))
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ -lm -o $@

$(RIG:%.c=$(OUT)/%): $(OUT)/%: $(OUT)/obj/%.o $(OUT)/liblinux_port.a
	@mkdir -p $(@D)
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ $(GPIOD_LIB) -lm -o $@

build/perf/libfloor.so: $(call object_of,$(PERF)) $(OUT)/libskiplatch_sim.a
	@mkdir -p $(@D)
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LTO) -shared $^ -lm -o $@

# ---- C tests -------------------------------------------------------------------------------------

# LINK.tests/unit/test_x, MOCK.… and CFLAGS.… of every test, read from the comments at its top.
build/tests.mk: $(TESTS) $(FUZZ) scripts/read_test_comments.awk
	@mkdir -p $(@D)
	@awk -f scripts/read_test_comments.awk $(TESTS) $(FUZZ) /dev/null >$@
include build/tests.mk

# $(call parts_of,tests/unit/test_x): what a test links.
sources_of = $(foreach pattern,$(LINK.$1),$(or $(wildcard $(pattern)),$(pattern)))
folder_of  = $(OUT)/$(if $(CFLAGS.$1),private/$1,obj)
whole_sim  = $(if $(filter tests/unit/%,$1),,$(OUT)/libskiplatch_sim.a)
parts_of   = $(if $(LINK.$1),$(patsubst %.c,$(folder_of)/%.o,$(sources_of)),$(whole_sim))
mocks_of   = $(patsubst %.h,build/mocks/mock_%.h,$(notdir $(MOCK.$1)))

MOCKED  := $(sort $(foreach test,$(TESTS:.c=),$(MOCK.$(test))))
# A mock includes the header it was made of without the folder.
CFLAGS.tests   += $(addprefix -I,$(sort $(dir $(MOCKED))))
CFLAGS.foreign += $(addprefix -I,$(sort $(dir $(MOCKED))))
RUNNERS := $(TESTS:%.c=build/runners/%.c)
generated: $(RUNNERS) $(patsubst %.h,build/mocks/mock_%.c,$(notdir $(MOCKED)))
	@:

build/runners/%.c: %.c
	@mkdir -p $(@D)
	@ruby -W0 $(UNITY)/auto/generate_test_runner.rb --use_param_tests=1 $< $@

define mock_rules
build/mocks/mock_$(notdir $(1:.h=)).c build/mocks/mock_$(notdir $1) &: $1 tests/support/cmock.yml
	@mkdir -p $$(@D)
	@ruby -W0 $(CMOCK)/lib/cmock.rb -otests/support/cmock.yml --mock_path=build/mocks $1
endef
$(foreach header,$(MOCKED),$(eval $(call mock_rules,$(header))))

# $1: the test without its ending
define test_rules
$(OUT)/obj/$1.o: private TEST_CFLAGS := $(CFLAGS.$1)
$(OUT)/obj/$1.o: | $(mocks_of)
$(OUT)/$1: $(OUT)/obj/$1.o $(OUT)/foreign/runners/$1.o $(mocks_of:build/%.h=$(OUT)/foreign/%.o) \
           $(OUT)/foreign/unity.o $(OUT)/foreign/cmock.o $(parts_of) $(call object_of,$(TARGET)) \
           $(if $(filter arm,$(FAMILY)),$(OUT)/libboard.a)
	@mkdir -p $$(@D)
	$(Q)$(CC) $(FLAGS) $$(LDFLAGS) -fno-lto $$^ -lm -o $$@
$(OUT)/foreign/runners/$1.o: | $(mocks_of)
$(if $(CFLAGS.$1),$(call private_rules,$1))
endef

# The sources a test compiles for itself, with its own flags.
define private_rules
$(OUT)/private/$1/%.o: %.c Makefile $1.c
	@mkdir -p $$(@D)
	$(SAY) '$(CC) $$<, for $1'
	$(Q)$(CC) $$(call cflags_of,$$<) $(CFLAGS.$1) -MMD -MP -c $$< -o $$@
endef
$(foreach test,$(TESTS:.c=),$(eval $(call test_rules,$(test))))

# $(call under_test,test_hal_x,PORT): what stands between a contract suite and that port.
under_test = $(if $(filter test_hal_pulse,$1),tests/support/pulse_lines_$2.c,\
               tests/support/port_$2.c tests/support/edge_log.c)

# The contract suites once more, on the Linux port.
CONTRACT_LINUX := $(if $(LINUX),$(filter-out %/test_hal_error.c,$(TESTS.contract)))
.PHONY: contract-linux-programs
contract-linux-programs: $(CONTRACT_LINUX:tests/contract/%.c=$(OUT)/contract-linux/%)
$(OUT)/contract-linux/%: $(OUT)/obj/tests/contract/%.o $(OUT)/foreign/runners/tests/contract/%.o \
                         $(OUT)/foreign/unity.o $$(call object_of,$$(call under_test,$$*,linux)) \
                         $(OUT)/liblinux_port.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) -fno-lto $^ $(GPIOD_LIB) -lm -o $@

# ---- suites on a board ---------------------------------------------------------------------------

AVR_TEST_RUN := build/host/avr_test_run

# What each family needs, and the command that installs it.
TOOLS.avr    := $(and $(shell command -v avr-gcc),$(wildcard /usr/include/simavr/sim_avr.h))
TOOLS.arm    := $(and $(shell command -v arm-none-eabi-gcc),$(shell command -v qemu-system-arm))
NO_TOOLS.avr := no avr-gcc or libsimavr here: scripts/setup_system.sh cross emulators
NO_TOOLS.arm := no arm-none-eabi-gcc or qemu-system-arm here: scripts/setup_system.sh cross emulators

# The contract suites, and the unit tests of the firmware but for its mathematics, which wants a
# double of 64 bits and the memory of a PC.
OFF_BOARD   := host_sim/% hal/ports/% firmware/comp/% firmware/transmission/% firmware/cycle/kinematics% \
               firmware/cycle/sphere%
is_portable = $(if $(filter $(OFF_BOARD),$(LINK.$(1:.c=))),,$1)
ON_BOARD    := $(TESTS.contract) $(foreach test,$(TESTS.unit),$(call is_portable,$(test)))
# A board without pulse inputs leaves that header of the HAL out.
no_pulses   = $(if $(wildcard hal/ports/$1/pulse.c),,%/test_hal_pulse.c)
on_board    = $(foreach test,$(filter-out $(call no_pulses,$1),$(ON_BOARD)),\
                $(RESULTS)/target-$1/$(basename $(notdir $(test))).log)
target_results = $(if $(TOOLS.$(FAMILY.$1)),$(call on_board,$1),$(RESULTS)/target-$1/tools.check)

.PHONY: $(ON_BOARDS:%=run-%)
# What others link of the board is there before: two makes at once would write the same objects.
$(ON_BOARDS:%=run-%): run-target-%: generated $$(addprefix linked-,$$(filter $$*,$(LINKED))) \
                      $$(if $$(filter avr,$$(FAMILY.$$*)),$$(if $$(TOOLS.avr),$(AVR_TEST_RUN)))
	@$(if $(TOOLS.$(FAMILY.$*)),$(MAKE) VARIANT=boards/$* RESULTS=$(RESULTS) run-on-board,\
	    scripts/run_check.sh $(RESULTS)/target-$*/tools.check target-$* \
	    $(call skip,$(NO_TOOLS.$(FAMILY.$*))))

$(OUT)/libboard.a: $(call object_of,$(filter-out $(MAINS),$(PORTS.boards/$(BOARD))) $(FIRMWARE))
	@rm -f $@
	@ar rcs $@ $^

$(OUT)/firmware.elf: $(call object_of,$(filter %/main.c,$(PORTS.boards/$(BOARD)))) $(OUT)/libboard.a
$(OUT)/transmission.elf: $(call object_of,$(HAS_SECOND)) $(OUT)/libboard.a
$(OUT)/firmware.elf $(OUT)/transmission.elf:
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) $(LDFLAGS) $^ -lm -o $@

# The port with one disturbance, compiled as a whole: its constants change any of its files.
DISTURBANCE.cortex_m3.other_interrupt  := -DDISTURBANCE_INTERRUPT_US=60u \
                                          -DDISTURBANCE_INTERRUPT_PERIOD_US=490u
DISTURBANCE.cortex_m3.critical_section := -DDISTURBANCE_CRITICAL_US=80u \
                                          -DDISTURBANCE_CRITICAL_PERIOD_US=490u
DISTURBANCE.cortex_m3.scan_body        := -DDISTURBANCE_SCAN_BODY_US=1400u \
                                          -DDISTURBANCE_SCAN_BODY_EVERY=8u
DISTURBANCE.cortex_m3.prescaler        := -DDISTURBANCE_PRESCALER_SHIFT=9u
DISTURBANCE.cortex_m3.software_filter  := -DDISTURBANCE_FILTER_SAMPLES=20u \
                                          -DDISTURBANCE_FILTER_PERIOD_US=10u
DISTURBANCE.atmega328p.other_interrupt  := -DDISTURBANCE_INTERRUPT_US=100 \
                                           -DDISTURBANCE_INTERRUPT_PERIOD_US=970
DISTURBANCE.atmega328p.critical_section := -DDISTURBANCE_CRITICAL_US=150 \
                                           -DDISTURBANCE_CRITICAL_PERIOD_US=970
DISTURBANCE.atmega328p.scan_body        := -DDISTURBANCE_SCAN_BODY_US=2800 \
                                           -DDISTURBANCE_SCAN_BODY_EVERY=8
DISTURBANCE.atmega328p.prescaler        := -DCLOCK_PRESCALER=64
DISTURBANCE.atmega328p.software_filter  := -DDISTURBANCE_FILTER_US=15
# On the AVR, firmware-pin_change.elf and firmware-pin_change-….elf take edges the other way.
names_of = $(subst -, ,$1)
left_out = hal/ports/$(BOARD)/edge_$(if $(filter pin_change,$(call names_of,$1)),capture,pin_change).c \
           %/pulse.c %/main_transmission.c
$(OUT)/firmware-%.elf: $(PORTS.boards/$(BOARD)) $(wildcard hal/ports/$(PORT)/*.h) Makefile \
                       $(call object_of,$(FIRMWARE))
	$(SAY) 'link $@'
	$(Q)$(CC) $(filter-out -fstack-usage,$(FLAGS)) $(CFLAGS.hal) \
	    $(foreach name,$(call names_of,$*),$(DISTURBANCE.$(BOARD).$(name))) $(LDFLAGS) \
	    $(filter-out $(call left_out,$*),$(filter %.c %.o,$^)) -lm -o $@

SIMAVR_RIG := build/host/simavr_rig
$(SIMAVR_RIG): tests/boards/simavr_rig.c
	@mkdir -p $(@D)
	$(Q)gcc -O2 -std=c11 $(filter-out -Wcast-qual,$(WARNINGS)) -isystem /usr/include/simavr $< \
	    -lsimavr -lelf -o $@

# One campaign of each build; TOUCHES on each path.
TOUCHES      ?= $(or $(TOUCHES.$(BOARD).$*),$(TOUCHES.$(BOARD)),2000)
DISTURBANCES := other_interrupt critical_section scan_body prescaler software_filter
# A captured stamp is proof against what delays an interrupt: those two also with the pin change.
BUILDS.cortex_m3  := nominal $(DISTURBANCES)
BUILDS.atmega328p := nominal $(DISTURBANCES) pin_change pin_change-other_interrupt \
                     pin_change-critical_section
TOUCHES.atmega328p            := 400
TOUCHES.atmega328p.nominal    := 10000
TOUCHES.atmega328p.pin_change := 2000
RIG.atmega328p        := tests.boards.simavr_rig
RIG_OPTIONS.atmega328p.nominal   := --stamp-ticks 1 --body-cycles 120
RIG_OPTIONS.atmega328p.other_interrupt  := --corrected
RIG_OPTIONS.atmega328p.critical_section := --corrected
RIG_OPTIONS.atmega328p.scan_body        := --corrected
RIG_OPTIONS.atmega328p.prescaler        := --corrected --prescaler 64
RIG_OPTIONS.atmega328p.software_filter  := --corrected
RIG_OPTIONS.atmega328p.pin_change       := --pin-change
RIG_OPTIONS.atmega328p.pin_change-other_interrupt  := --corrected --pin-change
RIG_OPTIONS.atmega328p.pin_change-critical_section := --corrected --pin-change
RIG.cortex_m3         := tests.boards.qemu_rig
RIG_OPTIONS.cortex_m3.prescaler        := --tick-shift 9
RIG_OPTIONS.cortex_m3.other_interrupt  := --paths s
RIG_OPTIONS.cortex_m3.critical_section := --paths s
campaigns: $(addprefix $(OUT)/campaigns/,$(addsuffix /touches.csv,$(BUILDS.$(BOARD)))) \
           $(if $(HAS_SECOND),transmission)
transmission: $(OUT)/transmission.elf $(SIMAVR_RIG)
	@echo "$(BOARD), transmission error:" && $(VENV_PYTHON) -m tests.boards.transmission_rig $<
board-programs: $(BUILDS.$(BOARD):%=$(OUT)/firmware-%.elf) \
                $(if $(HAS_SECOND),$(OUT)/transmission.elf)
	@:
$(OUT)/campaigns/%/touches.csv: $(OUT)/firmware-%.elf $(if $(filter avr,$(FAMILY)),$(SIMAVR_RIG)) FORCE
	@rm -rf $(@D)
	@echo "$(BOARD), $*:" && $(VENV_PYTHON) -m $(RIG.$(BOARD)) $< --out $(@D) --touches $(TOUCHES) \
	    $(RIG_OPTIONS.$(BOARD).$*)

# An AVR's suites keep their texts in RAM; avr_test_run gives the chip enough of it.
SUITE_LDFLAGS.avr := -Wl,--defsym=__DATA_REGION_LENGTH__=0x3D00 -Wl,--defsym=__stack=0x3FFF
$(OUT)/contract/% $(OUT)/tests/unit/%: LDFLAGS += $(SUITE_LDFLAGS.$(FAMILY))

$(OUT)/contract/%: $(OUT)/obj/tests/contract/%.o $(OUT)/foreign/runners/tests/contract/%.o \
                   $(OUT)/foreign/unity.o $$(call object_of,$$(call under_test,$$*,$(BOARD)) $(TARGET)) \
                   $(OUT)/libboard.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $(LDFLAGS) $^ -lm -o $@

$(AVR_TEST_RUN) build/host/atmega2560_run: build/host/%: tests/boards/%.c
	@mkdir -p $(@D)
	$(Q)gcc -O2 -std=c11 $(filter-out -Wcast-qual,$(WARNINGS)) -isystem /usr/include/simavr $< \
	    -lsimavr -lelf -o $@

RUN_SUITE.avr = tests/boards/run_suite_avr.sh $(BOARD)
RUN_SUITE.arm = tests/boards/run_suite_arm.sh
.PHONY: run-on-board
run-on-board: $(if $(BOARD),$(call on_board,$(BOARD)))
$(RESULTS)/target-$(BOARD)/%.log: $(OUT)/contract/% FORCE
	@$(RUN_SUITE.$(FAMILY)) $< $@
$(RESULTS)/target-$(BOARD)/%.log: $(OUT)/tests/unit/% FORCE
	@$(RUN_SUITE.$(FAMILY)) $< $@

# ---- suites --------------------------------------------------------------------------------------

RESULTS.unit            := $(TESTS.unit:tests/%.c=$(RESULTS)/%.log)
RESULTS.contract        := $(TESTS.contract:tests/%.c=$(RESULTS)/%.log)
RESULTS.scenario        := $(TESTS.scenario:tests/%.c=$(RESULTS)/%.log)
RESULTS.template        := $(RESULTS)/template/template.check
RESULTS.contract-linux  := $(RESULTS)/contract-linux/contract-linux.check
RESULTS.target-atmega328p := $(call target_results,atmega328p)
RESULTS.target-atmega2560 := $(call target_results,atmega2560)
RESULTS.target-cortex_m3  := $(call target_results,cortex_m3)
RESULTS.fuzz-regression := $(FUZZ:tests/fuzz/%.c=$(RESULTS)/fuzz-regression/%.check)
RESULTS.python          := $(if $(wildcard tests/python/test_*.py),$(RESULTS)/python/pytest.xml)
RESULTS.long            := $(if $(wildcard tests/python/test_*.py),$(RESULTS)/long/pytest.xml)
LINT := compile-gcc compile-clang compile-avr compile-arm compile-m0plus compile-m4f clang-format clang-tidy cppcheck \
        dependencies firmware isr-objects isr-calls size ruff-check ruff-format mypy shellcheck
RESULTS.lint            := $(LINT:%=$(RESULTS)/lint/%.check)

RESULTS.bench-vm        := $(RESULTS)/bench-vm/bench-vm.check
RESULTS.bench-host      := $(RESULTS)/bench-host/bench-host.check

.PHONY: $(addprefix run-,$(TEST_SUITES) long lint)
$(addprefix run-,$(C_SUITES) template contract-linux python long lint): run-%: $$(RESULTS.$$*)
	@:

check = @scripts/run_check.sh $@ $(basename $(@F))
skip  = sh -c 'echo "$1"; exit 77'
# $(call with_tool,avr-gcc,command): the command, or a loud skip where the tool is absent.
with_tool = $(if $(shell command -v $1),$2,$(call skip,no $1 here))

TEST_TIMEOUT_S := 300
$(RESULTS)/%.log: $(OUT)/tests/% FORCE
	@timeout $(TEST_TIMEOUT_S) $< >$@ 2>&1; echo "exit status $$?" >>$@
	@printf '%-40s %s\n' '$*' "$$(grep -E '^[0-9]+ Tests ' $@ || tail -n 1 $@)"

$(RESULTS)/template/template.check: $(if $(TEMPLATE),$(OUT)/template) FORCE
	$(check) $(if $(TEMPLATE),true,$(call skip,no template port))

# Where there are gpio-sim and vcan: in the bench's machine, or on a host that has them.
$(RESULTS)/contract-linux/contract-linux.check: contract-linux-programs FORCE
	$(check) $(if $(LINUX),tests/bench/run_contract.sh $(@D),$(call skip,no libgpiod 2 here))

PYTEST_OPTIONS := -c scripts/pyproject.toml --rootdir=. -o cache_dir=build/pytest_cache
$(RESULTS)/python/pytest.xml: MARKED = not long
$(RESULTS)/long/pytest.xml:   MARKED = long
# A file's tests share what is dear to make, and the last files are short ones; long ones share nothing.
$(RESULTS)/python/pytest.xml: PYTEST_DIST = loadfile --no-loadscope-reorder
$(RESULTS)/long/pytest.xml:   PYTEST_DIST = worksteal
$(RESULTS)/python/pytest.xml $(RESULTS)/long/pytest.xml: \
                              library program $(OUT)/inject-codec \
                              $(if $(TOOLS.arm),linked-cortex_m3) \
                              $(if $(TOOLS.avr),programs-atmega328p $(SIMAVR_RIG)) \
                              $(if $(TOOLS.avr),linked-atmega2560 build/host/atmega2560_run) FORCE
	@$(VENV_PYTHON) -m pytest $(PYTEST_OPTIONS) --numprocesses=$(shell nproc) --dist=$(PYTEST_DIST) \
	    -m '$(MARKED)' --quiet --junitxml=$@ tests/python || true

# Whatever the suite wrote beside its one declared result is counted as well.
$(RIG_SUITES:%=run-%): run-bench-%: program $(if $(LINUX),contract-linux-programs $(RIG:%.c=$(OUT)/%))
	@scripts/run_check.sh $(RESULTS)/bench-$*/bench-$*.check bench-$* \
	    $(if $(LINUX),tests/bench/run_suite.sh $* $(RESULTS)/bench-$*,$(call skip,no libgpiod 2 here))
	@sed -n '/^scan wake-up/,$$p' $(RESULTS)/bench-$*/bench.txt 2>/dev/null || true

run-fuzz-regression:
	@$(if $(FUZZ),$(MAKE) VARIANT=sanitize RESULTS=$(RESULTS) run-replay)

.PHONY: run-replay
run-replay: $(RESULTS.fuzz-regression)
$(RESULTS)/fuzz-regression/%.check: $(OUT)/replay/% FORCE
	$(check) $< $(wildcard tests/fuzz/corpus/$(*:fuzz_%=%)/*)

# ---- fuzzing -------------------------------------------------------------------------------------

# A fuzz target links like a test. libFuzzer brings main(), or fuzz_replay.c, which runs the seeds.
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

.PHONY: $(addprefix fuzz/,$(notdir $(basename $(FUZZ) $(FUZZ_PYTHON))))
$(FUZZ:tests/fuzz/%.c=fuzz/%): fuzz/fuzz_%: $(OUT)/fuzz/fuzz_%
	@mkdir -p $(OUT)/corpus/$* $(OUT)/findings
	$< -max_total_time=$(SECONDS) -print_final_stats=1 -artifact_prefix=$(OUT)/findings/$*- \
	    $(OUT)/corpus/$* $(wildcard tests/fuzz/corpus/$*)

$(FUZZ_PYTHON:tests/fuzz/%.py=fuzz/%): fuzz/%: tests/fuzz/%.py
	$(VENV_PYTHON) $< $(SECONDS)

# ---- static checks -------------------------------------------------------------------------------

$(RESULTS)/lint/compile-gcc.check: FORCE
	$(check) $(MAKE) VARIANT=gcc objects
$(RESULTS)/lint/compile-clang.check: FORCE
	$(check) $(MAKE) VARIANT=clang objects
$(RESULTS)/lint/compile-avr.check: FORCE
	$(check) $(call with_tool,avr-gcc,$(MAKE) VARIANT=avr objects)
$(RESULTS)/lint/compile-arm.check: FORCE
	$(check) $(call with_tool,arm-none-eabi-gcc,$(MAKE) VARIANT=arm objects)
$(RESULTS)/lint/compile-m0plus.check $(RESULTS)/lint/compile-m4f.check: \
        $(RESULTS)/lint/compile-%.check: FORCE
	$(check) $(call with_tool,arm-none-eabi-gcc,$(MAKE) VARIANT=boards/cortex_$* objects)

$(RESULTS)/lint/clang-format.check: FORCE
	$(check) .venv/bin/clang-format --dry-run -Werror $(or $(C_FILES),--version)
$(RESULTS)/lint/clang-tidy.check: FORCE
	$(check) $(MAKE) VARIANT=clang tidy
$(RESULTS)/lint/cppcheck.check: FORCE
	$(check) $(VENV_PYTHON) scripts/lint_cppcheck.py build/cppcheck
$(RESULTS)/lint/dependencies.check: FORCE
	$(check) $(VENV_PYTHON) scripts/lint_dependencies.py
$(RESULTS)/lint/firmware.check: FORCE
	$(check) $(VENV_PYTHON) scripts/lint_firmware.py
$(RESULTS)/lint/isr-objects.check: $(RESULTS)/lint/compile-avr.check
	$(check) $(call with_tool,avr-gcc,$(VENV_PYTHON) scripts/lint_isr_objects.py build/avr/obj)

$(RESULTS)/lint/isr-calls.check $(RESULTS)/lint/size.check: $(LINKED:%=linked-%) FORCE
$(RESULTS)/lint/isr-calls.check:
	$(check) $(if $(LINKED),$(VENV_PYTHON) scripts/lint_isr_calls.py $(WITH_FAMILY),$(NO_CROSS))
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

.PHONY: tidy
tidy: $(C_SOURCES:%=$(OUT)/tidy/%.ok)
$(OUT)/tidy/%.ok: % .clang-tidy Makefile $(C_HEADERS)
	@mkdir -p $(@D)
	@.venv/bin/clang-tidy --quiet $< -- $(filter-out -Werror,$(call cflags_of,$<))
	@touch $@

include $(wildcard mk/*.mk)
-include $(shell find $(OUT) -name '*.d' 2>/dev/null)
