/* Timer 0: an interrupt that works, or one that samples the line. */
#include "board.h"
#include "cortex_m.h"
#include "disturbance.h"
#include "drivers.h"
#include "lm3s6965.h"

/* Constants that are 0 in most builds. */
static const uint32_t INTERRUPT_US = DISTURBANCE_INTERRUPT_US;
static const uint32_t FILTER_SAMPLES = DISTURBANCE_FILTER_SAMPLES;

static volatile bool filter_level;
static uint32_t      filter_samples; /* in a row that differ from the level */

void disturbance_start(void)
{
    uint32_t period_us =
        FILTER_SAMPLES != 0u ? DISTURBANCE_FILTER_PERIOD_US : DISTURBANCE_INTERRUPT_PERIOD_US;

    filter_level = edge_pin_is_high();
    if (INTERRUPT_US != 0u || FILTER_SAMPLES != 0u) {
        cortex_m_enable_irq(IRQ_TIMER0, PRIORITY_EDGE);
        board_start_timer(TIMER_DISTURBANCE, period_us * BOARD_TICKS_PER_US);
    }
}

void disturbance_in_task(void)
{
    disturbance_critical_section();
}

bool disturbance_filtered(bool pin_is_high)
{
    return FILTER_SAMPLES == 0u ? pin_is_high : filter_level;
}

static void sample(void)
{
    bool is_high = edge_pin_is_high();

    filter_samples = is_high == filter_level ? 0u : filter_samples + 1u;
    if (filter_samples == FILTER_SAMPLES) {
        filter_samples = 0u;
        filter_level = is_high;
        edge_on_filtered(is_high);
    }
}

void disturbance_interrupt(void)
{
    TIMER_ICR(TIMER_DISTURBANCE) = TIMER_A;
    if (FILTER_SAMPLES != 0u) {
        sample();
    } else {
        disturbance_work(INTERRUPT_US);
    }
}
