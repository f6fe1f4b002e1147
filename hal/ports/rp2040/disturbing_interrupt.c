/* Alarm 0 of the timer: an interrupt that works, or one that samples the line. */
#include "disturbance.h"
#include "drivers.h"
#include "rp2040.h"

#define SOONEST_US 2

/* Constants that are 0 in most builds. */
static const uint32_t INTERRUPT_US = DISTURBANCE_INTERRUPT_US;
static const uint32_t FILTER_SAMPLES = DISTURBANCE_FILTER_SAMPLES;

static volatile bool filter_level;
static uint32_t      filter_samples; /* in a row that differ from the level */
static uint32_t      alarm_us;

/* One that has been missed is left out: an alarm of the past would come 71 minutes later. */
static void set_alarm(void)
{
    do {
        alarm_us +=
            FILTER_SAMPLES != 0u ? DISTURBANCE_FILTER_PERIOD_US : DISTURBANCE_INTERRUPT_PERIOD_US;
    } while ((int32_t)(alarm_us - TIMER_TIMERAWL) < SOONEST_US);
    TIMER_ALARM0 = alarm_us;
}

void disturbance_start(void)
{
    filter_level = edge_pin_is_high();
    if (INTERRUPT_US != 0u || FILTER_SAMPLES != 0u) {
        cortex_m_enable_irq(IRQ_TIMER_0, PRIORITY_EDGE);
        TIMER_INTE = ALARM_0;
        alarm_us = TIMER_TIMERAWL;
        set_alarm();
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
    TIMER_INTR = ALARM_0;
    set_alarm();
    if (FILTER_SAMPLES != 0u) {
        sample();
    } else {
        disturbance_work(INTERRUPT_US);
    }
}
