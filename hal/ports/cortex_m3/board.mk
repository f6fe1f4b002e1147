# LM3S6965 (Cortex-M3 at 50 MHz), run in QEMU's lm3s6965evb.
FAMILY.$(board)        := arm
SHARED.$(board)        := qemu
FLAGS.$(board)         := -mcpu=cortex-m3 -mthumb
LINKER_SCRIPT.$(board) := lm3s6965.ld

# To keep the port portable.
OTHER_CORES.$(board) := cortex_m0plus cortex_m4f
FLAGS.cortex_m0plus  := -mcpu=cortex-m0plus -mthumb
FLAGS.cortex_m4f     := -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard

DISTURBANCE.$(board).other_interrupt  := -DDISTURBANCE_INTERRUPT_US=60u \
                                         -DDISTURBANCE_INTERRUPT_PERIOD_US=490u
DISTURBANCE.$(board).critical_section := -DDISTURBANCE_CRITICAL_US=80u \
                                         -DDISTURBANCE_CRITICAL_PERIOD_US=490u
DISTURBANCE.$(board).scan_body        := -DDISTURBANCE_SCAN_BODY_US=1400u \
                                         -DDISTURBANCE_SCAN_BODY_EVERY=8u
DISTURBANCE.$(board).prescaler        := -DDISTURBANCE_PRESCALER_SHIFT=9u
DISTURBANCE.$(board).software_filter  := -DDISTURBANCE_FILTER_SAMPLES=20u \
                                         -DDISTURBANCE_FILTER_PERIOD_US=10u

BUILDS.$(board) := nominal other_interrupt critical_section scan_body prescaler software_filter
RIG.$(board)    := hal.ports.$(board).tests.qemu_rig
RIG_OPTIONS.$(board).prescaler        := --tick-shift 9
RIG_OPTIONS.$(board).other_interrupt  := --paths s
RIG_OPTIONS.$(board).critical_section := --paths s
