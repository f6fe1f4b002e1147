# RP2040 (Cortex-M0+ at 125 MHz), run in rp2040js. Its wiring is that of the boards in QEMU.
FAMILY.$(board)        := arm
SHARED.$(board)        := qemu
FLAGS.$(board)         := -mcpu=cortex-m0plus -mthumb
LINKER_SCRIPT.$(board) := rp2040.ld
NEEDS.$(board)         := build/rp2040js/node
SUITE_RUN.$(board)     := build/rp2040js/node hal/ports/$(board)/tests/suite.js
UNSUITED.$(board).test_latch_restart := it goes through all sequence numbers, too long for an emulator
UNSUITED.$(board).test_inject_guard  := it sends 320000 frames, too long for this emulator

DISTURBANCE.$(board).other_interrupt  := -DDISTURBANCE_INTERRUPT_US=60u \
                                         -DDISTURBANCE_INTERRUPT_PERIOD_US=490u
DISTURBANCE.$(board).critical_section := -DDISTURBANCE_CRITICAL_US=80u \
                                         -DDISTURBANCE_CRITICAL_PERIOD_US=490u
DISTURBANCE.$(board).scan_body        := -DDISTURBANCE_SCAN_BODY_US=1400u \
                                         -DDISTURBANCE_SCAN_BODY_EVERY=8u
DISTURBANCE.$(board).prescaler        := -DDISTURBANCE_PRESCALER_SHIFT=4u
DISTURBANCE.$(board).software_filter  := -DDISTURBANCE_FILTER_SAMPLES=20u \
                                         -DDISTURBANCE_FILTER_PERIOD_US=10u

# The skip input on core 1. A software filter would be core 0's.
DISTURBANCE.$(board).two_cores := -DBOARD_EDGE_CORE=1u
LEFT_OUT.$(board)               = $(if $(filter two_cores,$(in_build)),wiring.c)

BUILDS.$(board)          := nominal other_interrupt critical_section scan_body prescaler software_filter \
                            two_cores two_cores-other_interrupt two_cores-critical_section
TOUCHES.$(board).nominal := 10000
RIG.$(board)             := hal.ports.$(board).tests.rig
RIG_OPTIONS.$(board).prescaler        := --tick-shift 4
RIG_OPTIONS.$(board).other_interrupt  := --paths s
RIG_OPTIONS.$(board).critical_section := --paths s
RIG_OPTIONS.$(board).two_cores-other_interrupt  := --paths s
RIG_OPTIONS.$(board).two_cores-critical_section := --paths s
MEASURE.$(board)         = $(VENV_PYTHON) -m hal.ports.$(TARGET).tests.grblhal_rig $(OUT)/beside_grblhal.elf
