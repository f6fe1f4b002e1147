/*
 * The Cortex-M3 port under test: the interrupt output of timer 3 is wired to the trigger pin, and
 * the two UARTs to each other, by qemu_suite.py. Time passes by the watchdog; the timers cannot be
 * read there.
 */
#include "contract/port_under_test.h"
#include "../board.h"
#include "../lm3s6965.h"
#include "tests/wired_board.h"

#define WATCHDOG_LOAD  REGISTER(0x40000000u)
#define WATCHDOG_VALUE REGISTER(0x40000004u)
#define WATCHDOG_CTL   REGISTER(0x40000008u)
#define TIMER_LINE     3u

/* Frames go round by the host, some milliseconds of virtual time. */
const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = true,
    .filter_max_us = 0u,
    .filter_tried_us = 50u,
    .edge_latency_us = 5u,
    .frame_latency_us = 20000u,
    .time_error_us = 5u,
};

const uint32_t WIRED_TICKS_PER_US = BOARD_TICKS_PER_US;
const uint32_t WIRED_UART_IRQ = IRQ_UART0;

void wired_start(void)
{
    WATCHDOG_LOAD = UINT32_MAX;
    WATCHDOG_CTL = 1u;
    TIMER_CTL(TIMER_LINE) = 0u;
    TIMER_CFG(TIMER_LINE) = 0u;
    TIMER_TAMR(TIMER_LINE) = TAMR_ONE_SHOT;
    TIMER_TAILR(TIMER_LINE) = 1u;
    TIMER_IMR(TIMER_LINE) = TIMER_A;
    UART_LCRH(UART1) = LCRH_8_BITS | LCRH_FIFO;
    UART_CTL(UART1) = CTL_ENABLE;
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

int wired_hear(void)
{
    return (UART_FR(UART1) & FR_RX_EMPTY) == 0u ? (int)(UART_DR(UART1) & UINT8_MAX) : -1;
}
