# What there is to compile and to check.

FIRMWARE := $(wildcard firmware/*/*.c)
MAIN     := $(wildcard host_sim/main.c)
SIM      := $(filter-out $(MAIN),$(wildcard host_sim/*.c host_sim/effects/*.c host_sim/api/*.c))
# What the diagnosis computes in C.
DIAGNOSIS := $(wildcard scripts/skiplatch/diagnosis/*/*.c)
# The shared library: what Python calls.
IN_LIBRARY := $(FIRMWARE) $(SIM) $(DIAGNOSIS)
UNHOSTED := $(wildcard $(HOST_PORTS:%=hal/ports/%/*.c))

# What gcc's analyzer doubts, without those of the store that take long.
TESTS.memory   := $(filter-out %_cuts.c %_damage.c,$(wildcard tests/unit/test_kinematics_*.c))
TESTS.unit     := $(if $(filter memory,$(VARIANT)),$(TESTS.memory),\
                    $(wildcard tests/unit/test_*.c hal/ports/*/tests/test_*.c))
TESTS.contract := $(wildcard tests/contract/test_*.c)
TESTS.scenario := $(wildcard tests/scenario/test_*.c)
TESTS          := $(TESTS.unit) $(TESTS.contract) $(TESTS.scenario)
FUZZ           := $(wildcard tests/fuzz/fuzz_*.c)
FUZZ_PYTHON    := $(wildcard tests/fuzz/fuzz_*.py)
PERF           := $(wildcard tests/perf/*.c)
SOAK           := $(wildcard tests/soak/*.c)

# A board's headers are checked where its own are compiled.
headers_of = $(wildcard $(1:%=hal/ports/%/*.h))
C_SOURCES := $(IN_LIBRARY) $(MAIN) $(UNHOSTED) $(HOSTED)
C_HEADERS := $(wildcard firmware/*.h firmware/*/*.h hal/include/*.h host_sim/*.h host_sim/*/*.h \
                        $(DIAGNOSIS:.c=.h)) \
             $(call headers_of,$(HOST_PORTS)) $(if $(HOSTED),$(call headers_of,$(call ports_of,hosted)))
C_FILES   := $(sort $(C_SOURCES) $(C_HEADERS) \
                    $(wildcard hal/ports/*/*.[ch] hal/ports/*/tests/*.[ch] host_sim/tests/*.[ch] tests/*/*.[ch]))
PYTHON_FOLDERS := scripts $(wildcard tests hal)
PYTHON_FILES   := $(wildcard scripts/skiplatch) \
                  $(wildcard scripts/*.py scripts/lint/*.py tests/python/*.py tests/fuzz/*.py tests/perf/*.py \
                             tests/withheld/*.py tests/bench/*.py tests/boards/*.py hal/ports/*/tests/*.py)
SHELL_FILES    := $(wildcard scripts/*.sh scripts/setup/*.sh tests/*/*.sh hal/ports/*/*.sh) .ci/run

object_of = $(patsubst %.c,$(OUT)/obj/%.o,$1)
