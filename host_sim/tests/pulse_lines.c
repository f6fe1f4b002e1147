/* The pulse lines of the simulated rig. */
#include <stddef.h>

#include "../contract/pulse_lines_under_test.h"
#include "hal_clock.h"
#include "port.h"

#define TICK_NS 250

const pulse_facts_t PULSES = {.latency_us = 1u, .spacing_us = 1u, .held_most = SIM_PULSES_HELD};

static const sim_chain_t CHAIN = {
    .tick_us = TICK_NS / SIM_NS_PER_US,
    .scan_us = 4000.0,
    .resolution_um = 0.1,
    .accel_mm_s2 = 3000.0,
};

static sim_t             sim;
static sim_pulse_input_t input;

void pulse_lines_power_up(uint32_t ticks)
{
    sim_boot(&sim, &CHAIN, NULL, 0u, 1u, 0u, (sim_ns_t)ticks * TICK_NS);
    sim_port_bind(&sim);
    input = (sim_pulse_input_t){0};
    sim_port_bind_pulses(&input);
}

void pulse_line_set(uint8_t channel, bool high)
{
    sim_pulse_input_set(&input, channel, high, hal_clock_now_ticks());
}

void pulse_lines_pass_us(uint32_t us)
{
    sim.now += sim_ns_from_us(us);
}
