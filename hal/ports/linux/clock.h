/*
 * The clock of this port: CLOCK_MONOTONIC in nanoseconds, and the ticks that hal_clock.h makes of
 * it. The ticks are a function of CLOCK_MONOTONIC alone, so whoever reads the same clock can extend
 * them again: a tick is CLOCK_TICK_NS, and they wrap every 2^32 · 100 ns = 429 s.
 */
#ifndef LINUX_CLOCK_H
#define LINUX_CLOCK_H

#include <stdint.h>

#define CLOCK_TICK_NS   100u
#define CLOCK_NS_PER_US 1000u
#define CLOCK_NS_PER_S  1000000000u

/* CLOCK_MONOTONIC now. */
uint64_t clock_now_ns(void);

/* Ticks of an instant of CLOCK_MONOTONIC, modulo 2^32. */
uint32_t clock_ticks_of_ns(uint64_t monotonic_ns);

/*
 * An instant of CLOCK_REALTIME on CLOCK_MONOTONIC, by the offset between the two as it is now: if
 * the wall clock was stepped since that instant, the result is off by the step.
 */
uint64_t clock_monotonic_of_realtime_ns(uint64_t realtime_ns);

/* From now on all ticks are `shift_ticks` more than CLOCK_MONOTONIC says; 0 at the start. */
void clock_shift_ticks(uint32_t shift_ticks);

#endif
