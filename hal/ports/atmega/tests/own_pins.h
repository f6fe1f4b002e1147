/*
 * What a board with an ATmega adds to the port under test, beside its facts: the line is driven by
 * the pin's own output, which the chip sees as it sees a foreign one, and a timer that the port
 * does not use tells the time.
 */
#ifndef ATMEGA_OWN_PINS_H
#define ATMEGA_OWN_PINS_H

#include <stdbool.h>
#include <stdint.h>

/* All but the bus as after power-on, the line low, the clock at `ticks`. Interrupts masked. */
void own_start(uint32_t ticks);

/* Drive the trigger line. Task. */
void own_set_line(bool high);

/* Counts up twice a µs, from own_start_timer() on, and wraps at 256. */
void    own_start_timer(void);
uint8_t own_timer(void);

/* Put the axis of the board somewhere, at rest. Task. */
void own_place_axis(int32_t position_counts);

#endif
