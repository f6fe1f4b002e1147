/*
 * The Cortex-M3 port under test, in QEMU: the interrupt output of timer 3 is wired to the trigger
 * pin, and the two UARTs to each other, by qemu_suite.py. Time passes by the watchdog,
 * which the port does not use; the timers cannot be read there.
 *
 * The emulated UART takes no time for a byte. So that a queue can fill, its interrupt comes only
 * while time is let pass.
 */
#include "contract/port_under_test.h"
#include "../board.h"
#include "../lm3s6965.h"
#include "unity.h"

#define WATCHDOG_LOAD  REGISTER(0x40000000u)
#define WATCHDOG_VALUE REGISTER(0x40000004u)
#define WATCHDOG_CTL   REGISTER(0x40000008u)
#define TIMER_LINE     3u
#define HEARD_BYTES    1024u
#define FLUSH_US       20000u
#define LINE_READS     1000u

/* Frames go round by the host, some milliseconds of virtual time. */
const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = true,
    .filter_max_us = 0u,
    .filter_tried_us = 50u,
    .edge_latency_us = 5u,
    .frame_latency_us = FLUSH_US,
    .time_error_us = 5u,
};

static uint8_t  heard[HEARD_BYTES];
static uint32_t heard_count;
static uint32_t taken_count;

void board_on_scan(void)
{
}

static void start_line(void)
{
    TIMER_CTL(TIMER_LINE) = 0u;
    TIMER_CFG(TIMER_LINE) = 0u;
    TIMER_TAMR(TIMER_LINE) = TAMR_ONE_SHOT;
    TIMER_TAILR(TIMER_LINE) = 1u;
    TIMER_IMR(TIMER_LINE) = TIMER_A;
}

void port_set_line(uint8_t channel, bool high)
{
    if (channel != 0u || high == edge_pin_is_high()) {
        return;
    }
    if (high) {
        TIMER_CTL(TIMER_LINE) = TIMER_A;
    } else {
        TIMER_ICR(TIMER_LINE) = TIMER_A;
    }
    for (unsigned i = 0u; i < LINE_READS && edge_pin_is_high() != high; ++i) {
    }
    TEST_ASSERT_EQUAL_MESSAGE(high, edge_pin_is_high(), "timer 3 is not wired to the pin");
}

static void hear(void)
{
    while ((UART_FR(UART1) & FR_RX_EMPTY) == 0u) {
        heard[heard_count % HEARD_BYTES] = (uint8_t)UART_DR(UART1);
        ++heard_count;
    }
}

void port_pass_us(uint32_t us)
{
    uint32_t since = WATCHDOG_VALUE;
    NVIC_ISER(IRQ_UART0) = NVIC_BIT(IRQ_UART0);
    while ((uint32_t)(since - WATCHDOG_VALUE) < us * BOARD_TICKS_PER_US) {
        hear();
    }
    NVIC_ICER(IRQ_UART0) = NVIC_BIT(IRQ_UART0);
}

static void power_up(uint32_t ticks)
{
    board_start();
    WATCHDOG_LOAD = UINT32_MAX;
    WATCHDOG_CTL = 1u;
    start_line();
    port_set_line(0u, false);
    UART_LCRH(UART1) = LCRH_8_BITS | LCRH_FIFO;
    UART_CTL(UART1) = CTL_ENABLE;
    port_pass_us(FLUSH_US);
    heard_count = 0u;
    taken_count = 0u;
    clock_start(ticks);
}

void port_power_up(void)
{
    power_up(0u);
}

bool port_power_up_at(uint32_t ticks)
{
    power_up(ticks);
    return true;
}

void port_place_axis(uint8_t axis, int32_t position_counts)
{
    if (axis == 0u) {
        axis_place(position_counts);
    }
}

bool port_receive(uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if (heard_count - taken_count < HAL_BUS_FRAME_BYTES) {
        return false;
    }
    for (uint8_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        frame[i] = heard[taken_count % HEARD_BYTES];
        ++taken_count;
    }
    return true;
}
