# A kernel with a GPIO character device and SocketCAN. It runs here, as programs of its own.
FAMILY.$(board) := hosted

# libgpiod 2 of the system, or the one that setup.sh has unpacked aside; without it there is no Linux port.
GPIOD_SYSTEM := $(shell grep -ls gpiod_chip_request_lines /usr/include/gpiod.h)
GPIOD_ASIDE  := $(if $(GPIOD_SYSTEM),,$(wildcard build/gpiod/usr/include/gpiod.h))
GPIOD_LIB    := $(if $(GPIOD_SYSTEM),-lgpiod,$(wildcard build/gpiod/usr/lib/*/libgpiod.a))
CFLAGS.$(board) = $(filter-out -std=c99 -flto -ffat-lto-objects,$(CFLAGS.hal)) -std=c11 -D_GNU_SOURCE \
                $(if $(GPIOD_ASIDE),-isystem build/gpiod/usr/include)

HOSTED   := $(if $(GPIOD_LIB),$(wildcard hal/ports/linux/*.c))
INJECTOR := $(filter hal/ports/linux/injector%,$(HOSTED))
RECORDER := $(filter hal/ports/linux/recorder%,$(HOSTED))
CONTROL  := $(filter hal/ports/linux/main.c hal/ports/linux/options.c,$(HOSTED))

$(OUT)/liblinux_port.a: $$(call object_of,$$(filter-out $(CONTROL) $(INJECTOR) $(RECORDER),$(HOSTED)) \
                                          $$(FIRMWARE))
	@rm -f $@
	@ar rcs $@ $^

HOSTED_PROGRAMS := $(if $(HOSTED),$(addprefix $(OUT)/skiplatch-,controller injector recorder))
$(OUT)/skiplatch-controller: $$(call object_of,$(CONTROL)) $(OUT)/liblinux_port.a
$(OUT)/skiplatch-injector: $$(call object_of,$(INJECTOR)) $(OUT)/liblinux_port.a
$(OUT)/skiplatch-recorder: $$(call object_of,$(RECORDER)) $(OUT)/liblinux_port.a
$(HOSTED_PROGRAMS):
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ $(GPIOD_LIB) -lm -o $@

# The programs of the rig in tests/bench.
HOSTED_RIG := $(if $(HOSTED),$(wildcard tests/bench/*.c))
$(OUT)/tests/bench/%: $(OUT)/obj/tests/bench/%.o $(OUT)/liblinux_port.a
	@mkdir -p $(@D)
	$(SAY) 'link $@'
	$(Q)$(CC) $(FLAGS) -fno-lto $^ $(GPIOD_LIB) -lm -o $@

# The contract suites once more, on this port, where there are gpio-sim and vcan: in the bench's
# machine, or on a host that has them.
HOSTED_CONTRACT := $(if $(HOSTED),$(filter-out %/test_hal_error.c,$(wildcard tests/contract/test_*.c)))
HOSTED_SUITES   := contract-linux
.PHONY: contract-linux-programs run-contract-linux
contract-linux-programs: $(HOSTED_CONTRACT:tests/contract/%.c=$(OUT)/contract-linux/%)
$(OUT)/contract-linux/%: $(OUT)/obj/tests/contract/%.o $(OUT)/foreign/runners/tests/contract/%.o \
                         $(OUT)/foreign/unity.o $$(call object_of,$$(call under_test,$$*,linux)) \
                         $(OUT)/liblinux_port.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) -fno-lto $^ $(GPIOD_LIB) -lm -o $@

RESULTS.contract-linux := $(RESULTS)/contract-linux/contract-linux.check
run-contract-linux: $(RESULTS.contract-linux)
$(RESULTS.contract-linux): contract-linux-programs FORCE
	$(check) $(if $(HOSTED),tests/bench/run_contract.sh $(@D),$(call skip,no libgpiod 2 here))

# ---- the rig: one in the virtual machine, one on this host's vcan and gpio-sim ----

RIG_SUITES := bench-vm bench-host
.PHONY: $(RIG_SUITES) $(RIG_SUITES:%=run-%)
bench-vm: setup setup-test ## test the Linux port in a virtual machine with CAN and GPIO, and time it
	$(call run_suites,$@)
bench-host: setup setup-test ## the same on this host, as root, with vcan and gpio-sim
	$(call run_suites,$@)

RESULTS.bench-vm   := $(RESULTS)/bench-vm/bench-vm.check
RESULTS.bench-host := $(RESULTS)/bench-host/bench-host.check
# Whatever the suite wrote beside its one declared result is counted as well.
$(RIG_SUITES:%=run-%): run-bench-%: program $(if $(HOSTED),$(HOSTED_SUITES:%=%-programs) $(HOSTED_RIG:%.c=$(OUT)/%))
	@scripts/run_check.sh $(RESULTS)/bench-$*/bench-$*.check bench-$* \
	    $(if $(HOSTED),tests/bench/run_suite.sh $* $(RESULTS)/bench-$*,$(call skip,no libgpiod 2 here))
	@sed -n '/^scan wake-up/,$$p' $(RESULTS)/bench-$*/bench.txt 2>/dev/null || true
