/*
 * The device clock: Timer1, 16 bits, with its overflows counted above it. One tick is
 * CLOCK_PRESCALER cycles, 62.5 ns at 1; the clock wraps after 2^32 ticks, 268 s.
 */
#ifndef ATMEGA328P_CLOCK_H
#define ATMEGA328P_CLOCK_H

#include <avr/io.h>
#include <stdint.h>

#include "clock_join.h"

/* 1, 8 or 64 cycles a tick. */
#ifndef CLOCK_PRESCALER
#define CLOCK_PRESCALER 1
#endif

/* Overflows counted so far. Only for clock_overflows_before(). */
extern volatile uint16_t clock_overflows;

/* Start the clock at 0. Task, once, interrupts masked. */
void clock_start(void);

/* Set the clock. Task; only for tests of the wrap. */
void clock_set_ticks(uint32_t ticks);

/*
 * The overflows before a reading of Timer1, a capture for instance, at most half a turn of the
 * timer (2 ms at 62.5 ns) later. Interrupts masked.
 */
static inline uint16_t clock_overflows_before(uint16_t timer_ticks)
{
    return clock_join_overflows(clock_overflows, timer_ticks, (TIFR1 & _BV(TOV1)) != 0u);
}

#endif
