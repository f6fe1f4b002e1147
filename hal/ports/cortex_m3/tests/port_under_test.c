/*
 * The Cortex-M3 port under test: the interrupt output of timer 3 is wired to the trigger pin by
 * the emulator of its rig. Time passes by the watchdog; the timers cannot be read there.
 */
#include "../board.h"
#include "../lm3s6965.h"
#include "tests/wired_board.h"

#define WATCHDOG_LOAD  REGISTER(0x40000000u)
#define WATCHDOG_VALUE REGISTER(0x40000004u)
#define WATCHDOG_CTL   REGISTER(0x40000008u)
#define TIMER_LINE     3u

const uint32_t WIRED_TICKS_PER_US = BOARD_TICKS_PER_US;

void wired_let_uart(bool may_interrupt)
{
    cortex_m_let_irq(IRQ_UART0, may_interrupt);
}

void wired_start(void)
{
    WATCHDOG_LOAD = UINT32_MAX;
    WATCHDOG_CTL = 1u;
    TIMER_CTL(TIMER_LINE) = 0u;
    TIMER_CFG(TIMER_LINE) = 0u;
    TIMER_TAMR(TIMER_LINE) = TAMR_ONE_SHOT;
    TIMER_TAILR(TIMER_LINE) = 1u;
    TIMER_IMR(TIMER_LINE) = TIMER_A;
}

uint32_t wired_ticks(void)
{
    return 0u - WATCHDOG_VALUE;
}

void wired_set_line(bool high)
{
    if (high) {
        TIMER_CTL(TIMER_LINE) = TIMER_A;
    } else {
        TIMER_ICR(TIMER_LINE) = TIMER_A;
    }
}
