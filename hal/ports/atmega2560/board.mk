# ATmega2560 at 16 MHz, run in simavr.
FAMILY.$(board)    := avr
SHARED.$(board)    := atmega
FLAGS.$(board)     := -mmcu=atmega2560
RIG_TOOLS.$(board) := build/rigs/$(board)/tests/run
