/*
 * A board of this family under test, in QEMU.
 *
 * An emulated UART takes no time for a byte. So that a queue can fill, its interrupt comes only
 * while time is let pass.
 */
#include "contract/port_under_test.h"
#include "../cortex_m.h"
#include "../drivers.h"
#include "unity.h"
#include "wired_board.h"

#define HEARD_BYTES 1024u
#define LINE_READS  1000u

static uint8_t  heard[HEARD_BYTES];
static uint32_t heard_count;
static uint32_t taken_count;

void board_on_scan(void)
{
}

void port_set_line(uint8_t channel, bool high)
{
    if (channel != 0u || high == edge_pin_is_high()) {
        return;
    }
    wired_set_line(high);
    for (unsigned i = 0u; i < LINE_READS && edge_pin_is_high() != high; ++i) {
    }
    TEST_ASSERT_EQUAL_MESSAGE(high, edge_pin_is_high(), "nothing is wired to the pin");
}

static void hear(void)
{
    int byte = wired_hear();
    while (byte >= 0) {
        heard[heard_count % HEARD_BYTES] = (uint8_t)byte;
        ++heard_count;
        byte = wired_hear();
    }
}

void port_pass_us(uint32_t us)
{
    uint32_t since = wired_ticks();
    NVIC_ISER(WIRED_UART_IRQ) = NVIC_BIT(WIRED_UART_IRQ);
    while ((uint32_t)(wired_ticks() - since) < us * WIRED_TICKS_PER_US) {
        hear();
    }
    NVIC_ICER(WIRED_UART_IRQ) = NVIC_BIT(WIRED_UART_IRQ);
}

bool port_power_up_at(uint32_t ticks)
{
    board_start();
    wired_start();
    port_set_line(0u, false);
    port_pass_us(PORT.frame_latency_us);
    heard_count = 0u;
    taken_count = 0u;
    clock_start(ticks);
    return true;
}

void port_power_up(void)
{
    (void)port_power_up_at(0u);
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
