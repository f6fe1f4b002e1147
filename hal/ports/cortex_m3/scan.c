/* The PLC's scans: a timer that is reloaded by hardware, so that a late scan makes no later one. */
#include "board.h"
#include "disturbance.h"
#include "drivers.h"
#include "lm3s6965.h"

void scan_start(uint16_t period_us)
{
    cortex_m_enable_irq(IRQ_TIMER1, PRIORITY_SCAN);
    board_start_timer(TIMER_SCAN, period_us * BOARD_TICKS_PER_US);
}

void scan_interrupt(void)
{
    TIMER_ICR(TIMER_SCAN) = TIMER_A;
    board_on_scan();
    disturbance_in_scan();
}
