#include "disturbance.h"

#include <avr/interrupt.h>

#include "board.h"
#include "clock.h"
#include "edge_line.h"
#include "hal_clock.h"
#include "hal_critical.h"

#define CYCLES_PER_US (BOARD_CLOCK_HZ / 1000000ul)
#define TICKS(us)     ((uint16_t)((us) * CYCLES_PER_US / CLOCK_PRESCALER))

static inline void busy(uint32_t us)
{
    if (us != 0u) {
        __builtin_avr_delay_cycles(us * CYCLES_PER_US);
    }
}

ISR(TIMER1_COMPA_vect)
{
    OCR1A = (uint16_t)(OCR1A + TICKS(DISTURBANCE_INTERRUPT_PERIOD_US));
    busy(DISTURBANCE_INTERRUPT_US);
}

void disturbance_start(void)
{
    if (DISTURBANCE_INTERRUPT_US != 0) {
        OCR1A = TICKS(DISTURBANCE_INTERRUPT_PERIOD_US);
        TIMSK1 |= _BV(OCIE1A);
    }
}

void disturbance_in_task(void)
{
    static uint32_t last_ticks;
    if (DISTURBANCE_CRITICAL_US == 0) {
        return;
    }
    uint32_t now_ticks = hal_clock_now_ticks();
    if ((uint32_t)(now_ticks - last_ticks) >= TICKS(DISTURBANCE_CRITICAL_PERIOD_US)) {
        last_ticks = now_ticks;
        hal_critical_state_t saved = hal_critical_enter();
        busy(DISTURBANCE_CRITICAL_US);
        hal_critical_exit(saved);
    }
}

void disturbance_in_scan(void)
{
    static uint8_t scans;
    if (DISTURBANCE_SCAN_BODY_US != 0 && ++scans >= DISTURBANCE_SCAN_BODY_EVERY) {
        scans = 0u;
        busy(DISTURBANCE_SCAN_BODY_US);
    }
}

bool disturbance_passes_filter(uint16_t *timer_ticks)
{
    busy(DISTURBANCE_FILTER_US);
    *timer_ticks = TCNT1;
    return edge_line_is_deflected();
}
