# How each variant compiles:
#
# host      what setup, test and demo use
# sanitize  address and undefined-behaviour checks     gcc, clang  everything, compiled only
# coverage  counts what the tests reach                fuzz        libFuzzer
# memory    reads of what was never written, by clang    analyzer    gcc's own, compiled only
# boards/BOARD  firmware, port and suites for that board: mk/boards.mk

CC.host     := gcc
CC.gcc      := gcc
CC.sanitize := gcc
CC.coverage := gcc
CC.clang    := clang
CC.fuzz     := clang
CC.memory   := clang
CC.analyzer := gcc
CC          := $(or $(CC.$(VARIANT)),$(CC.$(FAMILY)))

SANITIZERS := -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
# Nobody looks at errno or at floating-point traps after a sum.
FLAGS.host     := -O3 -g -fno-math-errno -fno-trapping-math
FLAGS.gcc      := -O2
FLAGS.clang    := -O1
FLAGS.sanitize := -O1 -g $(SANITIZERS)
FLAGS.coverage := -O0 -g --coverage -fprofile-update=atomic
FLAGS.memory   := -O1 -g -fsanitize=memory -fno-sanitize-recover=all
# gcc 12 loses track of loops that fill arrays in turns and calls them uninitialized; instead those
# sources run in the variant memory.
FLAGS.analyzer := -O1 -fanalyzer -Wno-analyzer-use-of-uninitialized-value
FLAGS.fuzz     := -O1 -g $(SANITIZERS) -fsanitize=fuzzer-no-link

# Contracted multiply-adds would make figures depend on the processor.
FLAGS.hosted := -fPIC -fvisibility=hidden -pthread -ffp-contract=off
FLAGS.boards := -Os -g -ffunction-sections -fdata-sections -fstack-usage -Wl,--gc-sections
FLAGS := $(if $(TARGET),$(FLAGS.$(TARGET)) $(LIBRARY.$(FAMILY)) $(FLAGS.boards),$(FLAGS.$(VARIANT)) $(FLAGS.hosted))

WARNINGS := -Wall -Wextra -Wpedantic -Werror -Wcast-align -Wcast-qual -Wconversion -Wfloat-equal \
            -Wformat=2 -Wmissing-prototypes -Wpointer-arith -Wshadow -Wsign-conversion \
            -Wstrict-prototypes -Wundef -Wvla -Wwrite-strings
# What clang and the old compiler for the AVR do not know.
ifneq ($(filter host gcc analyzer,$(VARIANT)),)
WARNINGS += -Wduplicated-branches -Wduplicated-cond -Wlogical-op -Wnull-dereference
endif
# Instrumented code draws warnings that the plain one does not deserve.
ifneq ($(filter sanitize memory coverage fuzz,$(VARIANT)),)
WARNINGS := -w
endif

# Everything that clang knows, but for:
#   padded                       no structure is written out as bytes
#   declaration-after-statement  C99, where a value is first known
#   covered-switch-default, switch-enum   a damaged value takes the default, as gcc wants it
#   bad-function-cast            (int)lrint(x) says what it does
#   disabled-macro-expansion     the C library names a member and a macro alike (sa_handler)
#   unsafe-buffer-usage, pre-c11-compat, unknown-warning-option   of newer clangs: C has no other arrays
ifeq ($(VARIANT),clang)
EVERYTHING := -Weverything -Wno-unknown-warning-option $(addprefix -Wno-,padded bad-function-cast \
              declaration-after-statement covered-switch-default switch-enum \
              disabled-macro-expansion unsafe-buffer-usage pre-c11-compat)
endif

CMOCK := /usr/share/cmock
UNITY := $(CMOCK)/vendor/unity

INCLUDES        := -Ifirmware -Ihal/include -Ihost_sim -Iscripts/skiplatch
CFLAGS.firmware := -std=c99 $(WARNINGS) $(EVERYTHING) $(WARNINGS.$(FAMILY)) -Wdouble-promotion $(INCLUDES)
CFLAGS.hal      := $(CFLAGS.firmware) $(if $(TARGET),$(PORT_FOLDERS:%=-I%))
# On a host double costs nothing.
CFLAGS.host_sim := -std=c11 -D_GNU_SOURCE $(WARNINGS) $(EVERYTHING) \
                   $(if $(EVERYTHING),-Wno-double-promotion) $(INCLUDES)
# Unity compares floating-point numbers and calls test functions that have no prototype.
CFLAGS.tests    := -std=c11 -D_GNU_SOURCE $(WARNINGS) -Wno-missing-prototypes -Wno-float-equal \
                   $(INCLUDES) -Itests -Itests/support -Ibuild/mocks $(if $(TARGET),$(PORT_FOLDERS:%=-I%)) \
                   -DUNITY_INCLUDE_DOUBLE -isystem $(UNITY)/src -isystem $(CMOCK)/src
# Optimizing the library as a whole makes it faster by a third; tests link the plain code beside it.
ifeq ($(VARIANT),host)
CFLAGS.firmware += -flto -ffat-lto-objects
CFLAGS.host_sim += -flto -ffat-lto-objects
LTO             := -flto=auto
endif
# The C of the diagnosis is compiled as the simulation is.
CFLAGS.scripts  := $(CFLAGS.host_sim)
# What CMock and Unity wrote is not ours to mend.
CFLAGS.foreign  := -std=c11 -w $(INCLUDES) -Itests/support -Ibuild/mocks \
                   -DUNITY_INCLUDE_DOUBLE -I$(UNITY)/src -I$(CMOCK)/src

# A suite on a board speaks and ends through tests/support/target.h.
ifneq ($(TARGET),)
TARGET_UNITY   := -Itests/support -include target.h -DUNITY_OUTPUT_CHAR=target_put_char \
                  '-DUNITY_OUTPUT_CHAR_HEADER_DECLARATION=target_put_char(char)' \
                  -DUNITY_OUTPUT_COMPLETE=target_done -DUNITY_SUPPORT_64 -DCMOCK_MEM_SIZE=4096
CFLAGS.tests   += $(TARGET_UNITY) $(SUITE_CFLAGS.$(FAMILY))
CFLAGS.foreign += $(TARGET_UNITY)
endif

# Python calls this mathematics as it stands, so the shared library shows it.
SHOWN := firmware/comp/% firmware/cycle/overtravel.c
shown  = $(if $(filter $(SHOWN),$1),-fvisibility=default)

# $(call cflags_of,path/in/the/tree.c): the flags of the room the file stands in. The tests of a port
# are tests; a port may have a room of its own, with CFLAGS.PORT.
room_of   = $(if $(findstring /tests/,$1),tests,$(call outer_room,$(subst /, ,$1)))
outer_room = $(if $(CFLAGS.$(word 3,$1)),$(word 3,$1),$(firstword $1))
cflags_of = $(FLAGS) $(CFLAGS.$(call room_of,$1)) $(call shown,$1)

# What is compiled depends on its command and not on the rules: here is the command of each room.
quoted   = '$(subst ','\'',$1)'
commands = printf '%s\n' $(call quoted,$(CC) $(FLAGS) $(CFLAGS.$1) $(SHOWN)) \
           "$$($(CC) -dumpfullversion -dumpversion 2>/dev/null)"
$(OUT)/flags/%: FORCE
	@mkdir -p $(@D)
	@$(call commands,$*) | cmp -s - $@ || $(call commands,$*) >$@
