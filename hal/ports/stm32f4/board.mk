# STM32F405 (Cortex-M4 at 160 MHz), run in QEMU's netduinoplus2.
FAMILY.$(board)        := arm
SHARED.$(board)        := qemu
LINKER_SCRIPT.$(board) := stm32f405.ld
NEEDS.$(board)         := build/qemu/qemu-system-arm

# What the emulated chip has otherwise: clocks that nothing sets, and no GPIO. There the pin is wired
# to the interrupt output of USART3, so its level is what USART3's request is.
EMULATED := -DBOARD_SETS_CLOCKS=0 -DBOARD_CORE_MHZ=168u -DBOARD_TIMER_MHZ=1000u \
            -DEDGE_LEVEL_REGISTER=0x4000480Cu -DEDGE_LEVEL_BIT=7u
FLAGS.$(board) := -mcpu=cortex-m4 -mthumb $(EMULATED)

DISTURBANCE.$(board).other_interrupt  := -DDISTURBANCE_INTERRUPT_US=60u \
                                         -DDISTURBANCE_INTERRUPT_PERIOD_US=490u
DISTURBANCE.$(board).critical_section := -DDISTURBANCE_CRITICAL_US=80u \
                                         -DDISTURBANCE_CRITICAL_PERIOD_US=490u
DISTURBANCE.$(board).scan_body        := -DDISTURBANCE_SCAN_BODY_US=1400u \
                                         -DDISTURBANCE_SCAN_BODY_EVERY=8u
DISTURBANCE.$(board).prescaler        := -DDISTURBANCE_PRESCALER_SHIFT=9u

BUILDS.$(board)          := nominal other_interrupt critical_section scan_body prescaler
TOUCHES.$(board).nominal := 10000
RIG.$(board)             := hal.ports.$(board).tests.qemu_rig
RIG_OPTIONS.$(board).prescaler        := --tick-shift 9
RIG_OPTIONS.$(board).other_interrupt  := --paths s
RIG_OPTIONS.$(board).critical_section := --paths s
