/* The device clock: TIM2, which has all 32 bits, so that reading it is all there is to do. */
#include "board.h"
#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "stm32f405.h"

#define TICK_PS (1000000u / BOARD_TICKS_PER_US)

void clock_start(uint32_t ticks)
{
    uint32_t cycles = BOARD_TIMER_MHZ / BOARD_TICKS_PER_US << DISTURBANCE_PRESCALER_SHIFT;
    board_start_counter(TIM2, cycles, ticks);
}

uint32_t hal_clock_now_ticks(void)
{
    return TIM_CNT(TIM2);
}

uint32_t hal_clock_tick_ps(void)
{
    return TICK_PS << DISTURBANCE_PRESCALER_SHIFT;
}
