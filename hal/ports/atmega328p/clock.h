/*
 * The device clock: Timer1, 16 bits, with its overflows counted above it. One tick is
 * CLOCK_PRESCALER cycles, 62.5 ns at 1; the clock wraps after 2^32 ticks, 268 s.
 */
#ifndef ATMEGA328P_CLOCK_H
#define ATMEGA328P_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* 1, 8 or 64 cycles a tick. */
#ifndef CLOCK_PRESCALER
#define CLOCK_PRESCALER 1
#endif

/* Start the clock at 0. Task, once, interrupts masked. */
void clock_start(void);

/* Set the clock. Task; only for tests of the wrap. */
void clock_set_ticks(uint32_t ticks);

/*
 * A reading of Timer1, a capture for instance, as ticks of the clock. To be called within half a
 * turn of the timer (2 ms at 62.5 ns) after the reading, interrupts masked. ISR or critical
 * section.
 */
uint32_t clock_extend_ticks(uint16_t timer_ticks);

/*
 * The rule behind it: `overflows` have been counted. One more that is pending came before the
 * reading if the timer reads low, and after it if the timer reads high. Any context.
 */
static inline uint32_t clock_join_ticks(uint16_t overflows, uint16_t timer_ticks, bool is_pending)
{
    uint16_t high = overflows;
    if (is_pending && timer_ticks < 0x8000u) {
        ++high;
    }
    return (uint32_t)high << 16 | timer_ticks;
}

#endif
