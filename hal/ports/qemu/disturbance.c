#include "disturbance.h"

#include "board.h"
#include "hal_clock.h"
#include "hal_critical.h"

/* Constants that are 0 in most builds. */
static const uint32_t CRITICAL_US = DISTURBANCE_CRITICAL_US;
static const uint32_t SCAN_BODY_US = DISTURBANCE_SCAN_BODY_US;

static uint32_t critical_since_ticks;
static uint32_t scans;

static uint32_t clock_ticks(uint32_t us)
{
    return us * BOARD_TICKS_PER_US >> DISTURBANCE_PRESCALER_SHIFT;
}

void disturbance_work(uint32_t us)
{
    uint32_t since = hal_clock_now_ticks();
    while ((uint32_t)(hal_clock_now_ticks() - since) < clock_ticks(us)) {
    }
}

bool disturbance_is_due(uint32_t *since_ticks, uint32_t period_us)
{
    uint32_t now = hal_clock_now_ticks();
    bool     is_due = (uint32_t)(now - *since_ticks) >= clock_ticks(period_us);
    if (is_due) {
        *since_ticks = now;
    }
    return is_due;
}

void disturbance_critical_section(void)
{
    if (CRITICAL_US == 0u ||
        !disturbance_is_due(&critical_since_ticks, DISTURBANCE_CRITICAL_PERIOD_US)) {
        return;
    }
    hal_critical_state_t saved = hal_critical_enter();
    disturbance_work(CRITICAL_US);
    hal_critical_exit(saved);
}

void disturbance_in_scan(void)
{
    ++scans;
    if (SCAN_BODY_US != 0u && scans % DISTURBANCE_SCAN_BODY_EVERY == 0u) {
        disturbance_work(SCAN_BODY_US);
    }
}
