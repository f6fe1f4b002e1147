# The boards: every folder hal/ports/BOARD that has a board.mk. Here is how those are read, and what
# the boards of a family have in common; the rules stand in mk/on_board.mk. What is the same on
# all boards of a family stands in hal/ports/FAMILY, and is compiled for each as its own sources are.
#
# What a board.mk may say, all of it with `.$(board)` at the end of the name:
#
#   FAMILY       avr, arm, riscv: runs on a board of that compiler; host: compiled and linked here, run nowhere;
#                hosted: runs here by rules of its own, which set HOSTED (sources), HOSTED_PROGRAMS, HOSTED_SUITES
#                and HOSTED_RIG (sources)
#   SHARED       folder of hal/ports with what boards of one chip have in common, as FAMILY's is
#   FLAGS        the processor, for the compiler
#   LINKER_SCRIPT   in its folder
#   OTHER_CORES  names of cores that the port is linked and measured for as well; FLAGS.CORE of each
#   CONTRACT_ONLY   why the unit tests of the firmware are not run on it
#   UNSUITED.$(board).SUITE     why that one is not
#   SUITE_RUN    command that runs one suite, before the program's name; a family may know one
#   RIG          Python module that records a campaign of a build in the emulator
#   RIG_TOOLS    programs that rig or tests want: build/rigs/BOARD/tests/NAME of tests/NAME.c and NAME_*.c
#   BUILDS       the builds to record: nominal, and names joined by -
#   DISTURBANCE.$(board).NAME   flags of what a name in a build stands for
#   LEFT_OUT     files of its folders (SHARED, too) that no build holds; = and $(in_build) where it depends on it
#   TOUCHES, RIG_OPTIONS        how many on each path, and options of the rig; also ….BUILD
#   NEEDS        a program that the board wants besides; setup.sh in its folder sees to it
#   MEASURE      a command more to run in `make board`
#   SOAK         Python module that plays its builds at random in `make soak`, as SECONDS SEED say

PORTS := $(patsubst hal/ports/%/board.mk,%,$(wildcard hal/ports/*/board.mk))

define read_board
board := $1
include hal/ports/$1/board.mk
endef
$(foreach port,$(PORTS),$(eval $(call read_board,$(port))))

define read_core
PORT.$2   := $1
FAMILY.$2 := $(FAMILY.$1)
endef
$(foreach port,$(PORTS),$(foreach core,$(OTHER_CORES.$(port)),$(eval $(call read_core,$(port),$(core)))))

# ---- families ------------------------------------------------------------------------------------

CC.avr := avr-gcc
CC.arm := arm-none-eabi-gcc
CC.riscv := riscv64-unknown-elf-gcc

WARNINGS.arm      := -Wduplicated-branches -Wduplicated-cond -Wlogical-op -Wnull-dereference
WARNINGS.riscv    := $(WARNINGS.arm)
# The old compiler for the AVR warns of conversions that were asked for.
SUITE_CFLAGS.avr  := -Wno-conversion -Wno-sign-conversion
# An AVR's suites keep their texts in RAM; avr_test_run gives the chip enough of it.
SUITE_LDFLAGS.avr := -Wl,--defsym=__DATA_REGION_LENGTH__=0x3D00 -Wl,--defsym=__stack=0x3FFF
LDFLAGS.arm       := --specs=nano.specs -nostartfiles
# The library's headers belong to its specs, too.
LIBRARY.riscv     := --specs=picolibc.specs
LDFLAGS.riscv     := -nostartfiles

# The emulator of a board that runs in QEMU is its tests/emulator.py.
SUITE_RUN.arm  = .venv/bin/python -m tests.boards.qemu_suite hal.ports.$(PORT).tests.emulator
SUITE_RUN.riscv = $(SUITE_RUN.arm)
AVR_TEST_RUN  := build/rigs/avr_test_run
SUITE_RUN.avr  = $(AVR_TEST_RUN) $(patsubst -mmcu=%,%,$(filter -mmcu=%,$(FLAGS)))
UNSUITED.avr.test_overtravel := it holds the sums to 64 bits, and the double of avr-gcc has 32
UNSUITED.avr.test_latch_restart := it goes through all sequence numbers, too long for an emulator

# What each family needs, and the command that installs it.
TOOLS.avr    := $(and $(shell command -v avr-gcc),$(wildcard /usr/include/simavr/sim_avr.h))
TOOLS.arm    := $(and $(shell command -v arm-none-eabi-gcc),$(shell command -v qemu-system-arm))
TOOLS.riscv  := $(and $(shell command -v riscv64-unknown-elf-gcc),$(shell command -v qemu-system-riscv32))
NO_TOOLS.avr := no avr-gcc or libsimavr here: scripts/setup/system.sh cross emulators
NO_TOOLS.arm := no arm-none-eabi-gcc or qemu-system-arm here: scripts/setup/system.sh cross emulators
NO_TOOLS.riscv := no riscv64-unknown-elf-gcc or qemu-system-riscv32 here: scripts/setup/system.sh riscv

# ---- what follows --------------------------------------------------------------------------------

ports_of   = $(foreach port,$(PORTS),$(if $(filter $1,$(FAMILY.$(port))),$(port)))
BOARDS    := $(call ports_of,avr arm riscv)
HOST_PORTS := $(call ports_of,host)
CORES     := $(foreach board,$(BOARDS),$(OTHER_CORES.$(board)))
# What can be linked here; other cores are for the figures alone.
LINKED    := $(foreach board,$(BOARDS) $(CORES),\
               $(if $(shell command -v $(CC.$(FAMILY.$(board)))),$(board)))
# What can be run here.
emulator_of = hal/ports/$1/tests/emulator.py
runs_suites = $(or $(SUITE_RUN.$1),$(filter avr,$(FAMILY.$1)),$(wildcard $(call emulator_of,$1)))
tools_of    = $(and $(TOOLS.$(FAMILY.$1)),$(call runs_suites,$1),$(if $(NEEDS.$1),$(wildcard $(NEEDS.$1)),yes))
no_tools_of = $(strip $(if $(TOOLS.$(FAMILY.$1)),$(if $(call runs_suites,$1),no $(NEEDS.$1) here: hal/ports/$1/setup.sh,\
                  no $(call emulator_of,$1) yet (or a SUITE_RUN in board.mk): docs/PORTING.md),$(NO_TOOLS.$(FAMILY.$1))))
RUN_HERE   := $(foreach board,$(BOARDS),$(if $(call tools_of,$(board)),$(board)))

# Of this variant: the board (or core), and the folder its port is in.
TARGET  := $(patsubst boards/%,%,$(filter boards/%,$(VARIANT)))
FAMILY  := $(FAMILY.$(TARGET))
PORT    := $(or $(PORT.$(TARGET)),$(TARGET))
PORT_FOLDER   := hal/ports/$(PORT)
PORT_FOLDERS  := $(PORT_FOLDER) $(wildcard $(addprefix hal/ports/,$(FAMILY) $(SHARED.$(PORT))))
PORT_SOURCES  := $(if $(TARGET),$(wildcard $(PORT_FOLDERS:%=%/*.c)))
LINKER_SCRIPT := $(LINKER_SCRIPT.$(PORT):%=$(PORT_FOLDER)/%)
LINKER_SCRIPTS := $(LINKER_SCRIPT) $(if $(LINKER_SCRIPT),$(wildcard $(PORT_FOLDERS:%=%/*.ld)))
LDFLAGS       := $(LDFLAGS.$(FAMILY)) $(LINKER_SCRIPT:%=-T %)
ifneq ($(and $(TARGET),$(if $(FAMILY),,no)),)
$(error no board $(TARGET); there are: $(BOARDS) $(CORES))
endif
