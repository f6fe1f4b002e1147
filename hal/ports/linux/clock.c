#include "clock.h"

#include <time.h>

#include "hal_clock.h"

#define PS_PER_NS 1000u

static uint32_t shift;

static uint64_t read_ns(clockid_t id)
{
    struct timespec time;
    (void)clock_gettime(id, &time); /* both clocks exist on every Linux */
    return (uint64_t)time.tv_sec * CLOCK_NS_PER_S + (uint64_t)time.tv_nsec;
}

uint64_t clock_now_ns(void)
{
    return read_ns(CLOCK_MONOTONIC);
}

uint32_t clock_ticks_of_ns(uint64_t monotonic_ns)
{
    return (uint32_t)(monotonic_ns / CLOCK_TICK_NS) + shift;
}

/* The middle of two readings of one clock belongs to the reading of the other between them. */
uint64_t clock_monotonic_of_realtime_ns(uint64_t realtime_ns)
{
    uint64_t before = clock_now_ns();
    uint64_t realtime_now = read_ns(CLOCK_REALTIME);
    uint64_t after = clock_now_ns();
    return before + (after - before) / 2u - (realtime_now - realtime_ns);
}

void clock_shift_ticks(uint32_t shift_ticks)
{
    shift = shift_ticks;
}

uint32_t hal_clock_now_ticks(void)
{
    return clock_ticks_of_ns(clock_now_ns());
}

uint32_t hal_clock_tick_ps(void)
{
    return CLOCK_TICK_NS * PS_PER_NS;
}
