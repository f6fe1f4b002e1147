/*
 * The axis: a PWM slice makes the steps, and its interrupt counts them. One word, so that it cannot
 * be read torn.
 */
#include "board.h"
#include "drivers.h"
#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "rp2040.h"

#define AXIS 0u

/* Of 5 µm each: at most one may fall due while interrupts are masked, or steps are lost. */
#define STEP_US_AT_1_MM_PER_MIN 300000u

static volatile int32_t axis_counts;

/* When the axis began to run. Nothing in the firmware needs it; a rig reads it in memory, and knows
 * from it where the axis is between two steps. */
static volatile uint32_t axis_started_ticks;

void axis_place(int32_t position_counts)
{
    PWM_CSR(SLICE_AXIS) = 0u;
    PWM_INTE = 0u;
    PWM_INTR = PWM_SLICE(SLICE_AXIS);
    NVIC_ICPR(IRQ_PWM_WRAP) = NVIC_BIT(IRQ_PWM_WRAP);
    axis_counts = position_counts;
}

void axis_run(uint32_t feed_mm_per_min)
{
    axis_place(0);
    if (feed_mm_per_min == 0u) {
        return;
    }
    uint32_t period_us = STEP_US_AT_1_MM_PER_MIN / feed_mm_per_min;
    cortex_m_enable_irq(IRQ_PWM_WRAP, PRIORITY_AXIS);
    PWM_INTE = PWM_SLICE(SLICE_AXIS);
    hal_critical_state_t saved = hal_critical_enter();
    axis_started_ticks = hal_clock_now_ticks();
    board_start_slice(SLICE_AXIS, period_us - 1u);
    hal_critical_exit(saved);
}

void axis_on_step(void)
{
    PWM_INTR = PWM_SLICE(SLICE_AXIS);
    ++axis_counts;
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    return axis == AXIS ? axis_counts : 0;
}
