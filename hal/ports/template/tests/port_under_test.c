/*
 * What the contract suites want of a board, with empty bodies: fill each in where its comment
 * stands. It runs on the board itself, beside the suite.
 */
#include "contract/port_under_test.h"

/* Bounds, from the data sheet and a few tries. */
const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = false,
    .filter_max_us = 0u,
    .filter_tried_us = 50u,
    .edge_latency_us = 20u,
    .frame_latency_us = 1000u,
    .time_error_us = 10u,
};

void port_power_up(void)
{
    /* Start the board, the line low, nothing armed, the axis at 0, and forget what was heard. */
}

bool port_power_up_at(uint32_t ticks)
{
    /* The same, and start the clock at this count, for the tests of the wrap. */
    (void)ticks;
    port_power_up();
    return false;
}

void port_pass_us(uint32_t us)
{
    /* Poll a timer that the port does not use. */
    (void)us;
}

void port_set_line(uint8_t channel, bool high)
{
    /* Drive the trigger line: by the pin's own output, a wire, or the emulator. */
    (void)channel;
    (void)high;
}

void port_place_axis(uint8_t axis, int32_t position_counts)
{
    /* Write the counter of the axis. */
    (void)axis;
    (void)position_counts;
}

bool port_receive(uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    /* The next eight bytes that have come back over a wire from TXD to RXD, or CAN loop-back. */
    (void)frame;
    return false;
}
