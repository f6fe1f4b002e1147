#include "disturbance.h"

#include "board.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "lm3s6965.h"

/* Constants that are 0 in most builds. */
static const uint32_t INTERRUPT_US = DISTURBANCE_INTERRUPT_US;
static const uint32_t CRITICAL_US = DISTURBANCE_CRITICAL_US;
static const uint32_t SCAN_BODY_US = DISTURBANCE_SCAN_BODY_US;
static const uint32_t FILTER_SAMPLES = DISTURBANCE_FILTER_SAMPLES;

static volatile bool filter_level;
static uint32_t      filter_samples; /* in a row that differ from the level */
static uint32_t      critical_since_ticks;
static uint32_t      scans;

static uint32_t core_ticks(uint32_t us)
{
    return us * BOARD_TICKS_PER_US >> DISTURBANCE_PRESCALER_SHIFT;
}

static void work(uint32_t us)
{
    uint32_t since = hal_clock_now_ticks();
    while ((uint32_t)(hal_clock_now_ticks() - since) < core_ticks(us)) {
    }
}

void disturbance_start(void)
{
    uint32_t period_us =
        FILTER_SAMPLES != 0u ? DISTURBANCE_FILTER_PERIOD_US : DISTURBANCE_INTERRUPT_PERIOD_US;

    filter_level = edge_pin_is_high();
    critical_since_ticks = hal_clock_now_ticks();
    if (INTERRUPT_US != 0u || FILTER_SAMPLES != 0u) {
        board_enable_irq(IRQ_TIMER0, PRIORITY_EDGE);
        board_start_timer(TIMER_DISTURBANCE, period_us * BOARD_TICKS_PER_US);
    }
}

void disturbance_in_task(void)
{
    if (CRITICAL_US == 0u || (uint32_t)(hal_clock_now_ticks() - critical_since_ticks) <
                                 core_ticks(DISTURBANCE_CRITICAL_PERIOD_US)) {
        return;
    }
    hal_critical_state_t saved = hal_critical_enter();
    critical_since_ticks = hal_clock_now_ticks();
    work(CRITICAL_US);
    hal_critical_exit(saved);
}

void disturbance_in_scan(void)
{
    ++scans;
    if (SCAN_BODY_US != 0u && scans % DISTURBANCE_SCAN_BODY_EVERY == 0u) {
        work(SCAN_BODY_US);
    }
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
        work(INTERRUPT_US);
    }
}
