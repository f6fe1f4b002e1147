/*
 * The device clock: the chip's timer, which counts µs. Its lower word is the whole clock, so that
 * reading it is all there is to do.
 */
#include "board.h"
#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "rp2040.h"

#define TICK_PS (1000000u / BOARD_TICKS_PER_US)

/* A rig reads it in memory. The timer itself goes on: others may use its alarms. */
static volatile uint32_t clock_offset_ticks;

/* A coarser clock is good for 71 minutes: its upper bits are missing. */
static uint32_t ticks_since_reset(void)
{
    return TIMER_TIMERAWL >> DISTURBANCE_PRESCALER_SHIFT;
}

void clock_start(uint32_t ticks)
{
    clock_offset_ticks = ticks - ticks_since_reset();
}

uint32_t hal_clock_now_ticks(void)
{
    return ticks_since_reset() + clock_offset_ticks;
}

uint32_t hal_clock_tick_ps(void)
{
    return TICK_PS << DISTURBANCE_PRESCALER_SHIFT;
}
