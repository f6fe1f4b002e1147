/*
 * The axis: TIM5 counts 0.1 µm, 32 bits by hardware. What would be the pulses of a scale is here
 * its prescaler, so that the axis moves by itself, as evenly as the timer's clock.
 */
#include "board.h"
#include "drivers.h"
#include "hal_axis.h"
#include "stm32f405.h"

#define AXIS 0u

/* Cycles of the timer a count are this over mm/min: 60 s, 10,000 counts a mm. */
#define CYCLES_AT_1_MM_PER_MIN (BOARD_TIMER_MHZ * 6000u)

/* An emulated timer counts on when it is stopped. */
static volatile bool    axis_rests;
static volatile int32_t axis_rest_counts;

void axis_place(int32_t position_counts)
{
    axis_rests = true;
    axis_rest_counts = position_counts;
}

void axis_run(uint32_t feed_mm_per_min)
{
    axis_place(0);
    if (feed_mm_per_min != 0u) {
        board_start_counter(TIM5, CYCLES_AT_1_MM_PER_MIN / feed_mm_per_min, 0u);
        axis_rests = false;
    }
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    if (axis != AXIS) {
        return 0;
    }
    return axis_rests ? axis_rest_counts : (int32_t)TIM_CNT(TIM5);
}
