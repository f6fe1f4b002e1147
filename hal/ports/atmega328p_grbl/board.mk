# ATmega328P at 16 MHz with the pins and timers of grbl, run in simavr.
FAMILY.$(board) := avr
SHARED.$(board) := atmega
FLAGS.$(board)  := -mmcu=atmega328p
CONTRACT_ONLY.$(board) := the same chip and compiler as atmega328p

BUILDS.$(board)    := nominal
TOUCHES.$(board)   := 10000
RIG.$(board)       := hal.ports.$(board).tests.grbl_rig
RIG_TOOLS.$(board) := build/rigs/atmega328p/tests/simavr_rig
