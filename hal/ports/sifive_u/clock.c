/* The device clock: the cycles of the core, in ticks of 8 of them. */
#include "board.h"
#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "riscv.h"

#define TICK_SHIFT (BOARD_CYCLE_SHIFT + DISTURBANCE_PRESCALER_SHIFT)
#define TICK_PS    (1000000u / BOARD_TICKS_PER_US)

/* A rig reads it in memory. */
static volatile uint32_t clock_offset_ticks;

static uint32_t ticks_since_reset(void)
{
    return (uint32_t)(riscv_cycles() >> TICK_SHIFT);
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
