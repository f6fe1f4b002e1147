# ATmega328P at 16 MHz, run in simavr.
FAMILY.$(board) := avr
SHARED.$(board) := atmega
FLAGS.$(board)  := -mmcu=atmega328p

DISTURBANCE.$(board).other_interrupt  := -DDISTURBANCE_INTERRUPT_US=100 \
                                         -DDISTURBANCE_INTERRUPT_PERIOD_US=970
DISTURBANCE.$(board).critical_section := -DDISTURBANCE_CRITICAL_US=150 \
                                         -DDISTURBANCE_CRITICAL_PERIOD_US=970
DISTURBANCE.$(board).scan_body        := -DDISTURBANCE_SCAN_BODY_US=2800 \
                                         -DDISTURBANCE_SCAN_BODY_EVERY=8
DISTURBANCE.$(board).prescaler        := -DCLOCK_PRESCALER=64
DISTURBANCE.$(board).software_filter  := -DDISTURBANCE_FILTER_US=15

# A captured stamp is proof against what delays an interrupt: those two also with the pin change.
BUILDS.$(board) := nominal other_interrupt critical_section scan_body prescaler software_filter \
                   pin_change pin_change-other_interrupt pin_change-critical_section
# `pin_change` takes edges the other way; pulses are the second program's.
LEFT_OUT.$(board) = pulse.c edge_$(if $(filter pin_change,$(in_build)),capture,pin_change).c

TOUCHES.$(board)            := 400
TOUCHES.$(board).nominal    := 10000
TOUCHES.$(board).pin_change := 2000
RIG.$(board)       := hal.ports.$(board).tests.simavr_rig
RIG_TOOLS.$(board) := build/rigs/$(board)/tests/simavr_rig
RIG_OPTIONS.$(board).nominal          := --stamp-ticks 1 --body-cycles 120
RIG_OPTIONS.$(board).other_interrupt  := --corrected
RIG_OPTIONS.$(board).critical_section := --corrected
RIG_OPTIONS.$(board).scan_body        := --corrected
RIG_OPTIONS.$(board).prescaler        := --corrected --prescaler 64
RIG_OPTIONS.$(board).software_filter  := --corrected
RIG_OPTIONS.$(board).pin_change       := --pin-change
RIG_OPTIONS.$(board).pin_change-other_interrupt  := --corrected --pin-change
RIG_OPTIONS.$(board).pin_change-critical_section := --corrected --pin-change

# How fast and how well the second program measures.
MEASURE.$(board) = $(VENV_PYTHON) -m hal.ports.$(TARGET).tests.transmission_rig $(OUT)/transmission.elf

# For as long as it is let, beside the simulated rig.
SOAK.$(board) := hal.ports.$(board).tests.soak
