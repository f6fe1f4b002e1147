/*
 * A board in QEMU or rp2040js under test. What its UART sends is a file, which is read by
 * semihosting: that takes no time.
 *
 * Nor does a byte on an emulated UART. So that a queue can fill, its interrupt comes only
 * while time is let pass.
 */
#include "contract/port_under_test.h"
#include "../drivers.h"
#include "target.h"
#include "unity.h"
#include "wired_board.h"

const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = true,
    .filter_max_us = 0u,
    .filter_tried_us = 50u,
    .edge_latency_us = 5u,
    .frame_latency_us = 2000u,
    .time_error_us = 5u,
};

#define HEARD_BYTES 1024u
#define LINE_READS  1000u

#define SYS_OPEN    0x01u
#define SYS_READ    0x06u
#define OPEN_BINARY 1u

static const char SENT[] = "sent";

static uint32_t sent_handle;

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

static void start_hearing(void)
{
    const uint32_t file[] = {(uint32_t)(uintptr_t)SENT, OPEN_BINARY, sizeof SENT - 1u};

    if (sent_handle == 0u) {
        sent_handle = target_ask_host(SYS_OPEN, file);
    }
}

/* The host answers how many bytes were not read. */
static void hear(void)
{
    uint8_t        byte = 0u;
    const uint32_t place[] = {sent_handle, (uint32_t)(uintptr_t)&byte, 1u};

    while (target_ask_host(SYS_READ, place) == 0u) {
        heard[heard_count % HEARD_BYTES] = byte;
        ++heard_count;
    }
}

void port_pass_us(uint32_t us)
{
    uint32_t since = wired_ticks();
    wired_let_uart(true);
    while ((uint32_t)(wired_ticks() - since) < us * WIRED_TICKS_PER_US) {
        hear();
    }
    wired_let_uart(false);
}

bool port_power_up_at(uint32_t ticks)
{
    board_start();
    wired_start();
    start_hearing();
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
