# SiFive's FU540 in 32 bits, on its hart 0 (rv32imac at 1 GHz), run in QEMU's sifive_u.
FAMILY.$(board)        := riscv
SHARED.$(board)        := qemu
# In that version of the instruction set the compiler has libraries for what it takes CSRs.
FLAGS.$(board)         := -march=rv32imac -mabi=ilp32 -misa-spec=2.2
LINKER_SCRIPT.$(board) := fu540.ld
CONTRACT_ONLY.$(board) := what is portable is tried on four other chips

DISTURBANCE.$(board).other_interrupt  := -DDISTURBANCE_INTERRUPT_US=60u \
                                         -DDISTURBANCE_INTERRUPT_PERIOD_US=490u
DISTURBANCE.$(board).critical_section := -DDISTURBANCE_CRITICAL_US=80u \
                                         -DDISTURBANCE_CRITICAL_PERIOD_US=490u
DISTURBANCE.$(board).scan_body        := -DDISTURBANCE_SCAN_BODY_US=1400u \
                                         -DDISTURBANCE_SCAN_BODY_EVERY=8u
DISTURBANCE.$(board).prescaler        := -DDISTURBANCE_PRESCALER_SHIFT=10u

BUILDS.$(board)          := nominal other_interrupt critical_section scan_body prescaler
TOUCHES.$(board).nominal := 10000
RIG.$(board)             := hal.ports.$(board).tests.qemu_rig
RIG_OPTIONS.$(board).prescaler        := --tick-shift 10
RIG_OPTIONS.$(board).other_interrupt  := --paths s
RIG_OPTIONS.$(board).critical_section := --paths s
