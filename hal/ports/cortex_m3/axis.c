/*
 * The axis: a timer makes the steps, and its interrupt counts them. One word, so that it cannot be
 * read torn.
 */
#include "board.h"
#include "drivers.h"
#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "lm3s6965.h"

#define AXIS 0u

/* Of 5 µm each: at most one may fall due while interrupts are masked, or steps are lost. */
#define STEP_TICKS_AT_1_MM_PER_MIN 15000000u

static volatile int32_t axis_counts;

/* When the axis began to run. Nothing in the firmware needs it; a rig reads it in memory, and knows
 * from it where the axis is between two steps. */
static volatile uint32_t axis_started_ticks;

void axis_place(int32_t position_counts)
{
    TIMER_CTL(TIMER_AXIS) = 0u;
    TIMER_ICR(TIMER_AXIS) = TIMER_A;
    NVIC_ICPR(IRQ_TIMER2) = NVIC_BIT(IRQ_TIMER2);
    axis_counts = position_counts;
}

void axis_run(uint32_t feed_mm_per_min)
{
    uint32_t period_ticks =
        feed_mm_per_min == 0u ? 0u : STEP_TICKS_AT_1_MM_PER_MIN / feed_mm_per_min;

    axis_place(0);
    cortex_m_enable_irq(IRQ_TIMER2, PRIORITY_AXIS);
    hal_critical_state_t saved = hal_critical_enter();
    axis_started_ticks = hal_clock_now_ticks();
    if (period_ticks != 0u) {
        board_start_timer(TIMER_AXIS, period_ticks);
    }
    hal_critical_exit(saved);
}

void axis_on_step(void)
{
    TIMER_ICR(TIMER_AXIS) = TIMER_A;
    ++axis_counts;
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    return axis == AXIS ? axis_counts : 0;
}
