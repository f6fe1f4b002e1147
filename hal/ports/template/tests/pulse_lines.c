/* What test_hal_pulse wants of a board with two pulse inputs; any other leaves the file out. */
#include "contract/pulse_lines_under_test.h"

const pulse_facts_t PULSES = {.latency_us = 30u, .spacing_us = 20u, .held_most = 64u};

void pulse_lines_power_up(uint32_t ticks)
{
    /* Start the board, both lines low and none watched, the clock at this count. */
    (void)ticks;
}

void pulse_line_set(uint8_t channel, bool high)
{
    /* Drive the line. */
    (void)channel;
    (void)high;
}

void pulse_lines_pass_us(uint32_t us)
{
    /* Poll a timer that the port does not use. */
    (void)us;
}
