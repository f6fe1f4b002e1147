/* How a 16-bit reading of a timer and the count of its overflows become one time. */
#ifndef ATMEGA328P_CLOCK_JOIN_H
#define ATMEGA328P_CLOCK_JOIN_H

#include <stdbool.h>
#include <stdint.h>

/*
 * The overflows before a reading, of which `counted` have been counted. One more that is pending
 * came before the reading if the timer read low, and after it if the timer read high: right if the
 * flag is looked at within half a turn of the timer after the reading. Any context.
 */
static inline uint16_t clock_join_overflows(uint16_t counted, uint16_t timer_ticks, bool is_pending)
{
    return is_pending && timer_ticks < 0x8000u ? (uint16_t)(counted + 1u) : counted;
}

/* Both as one time that wraps at 2^32. Any context. */
static inline uint32_t clock_join_ticks(uint16_t overflows, uint16_t timer_ticks)
{
    return (uint32_t)overflows << 16 | timer_ticks;
}

#endif
