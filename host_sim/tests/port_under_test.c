/* The simulated rig as a port under test. */
#include <string.h>

#include "../contract/port_under_test.h"
#include "port.h"
#include "sim.h"

#define RECEIVED_MAX 64u
#define LATENCY_US   2.0
#define JITTER_US    0.5
#define TICK_NS      250

const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = false,
    .filter_max_us = UINT16_MAX,
    .filter_tried_us = 50u,
    .edge_latency_us = 3u,
    .frame_latency_us = 600u,
    .time_error_us = 0u,
};

static const sim_chain_t CHAIN = {
    .skip_latency_us = LATENCY_US,
    .skip_jitter_us = JITTER_US,
    .tick_us = TICK_NS / SIM_NS_PER_US,
    .scan_us = 4000.0,
    .resolution_um = 0.1,
    .accel_mm_s2 = 3000.0,
    .report_latency_us = 500.0,
    .report_jitter_us = 100.0,
};

static sim_t       sim;
static sim_touch_t touch;
static uint8_t     received[RECEIVED_MAX][HAL_BUS_FRAME_BYTES];
static unsigned    arrived;
static unsigned    taken;

static void power_up(sim_ns_t now)
{
    touch = (sim_touch_t){.time_s = (double)now / SIM_NS_PER_S, .sign = 1.0};
    sim_boot(&sim, &CHAIN, NULL, 0u, 1u, 0u, now);
    sim_port_bind(&sim);
    sim_begin_touch(&sim, &touch);
    arrived = 0u;
    taken = 0u;
}

void port_power_up(void)
{
    power_up(0);
}

bool port_power_up_at(uint32_t ticks)
{
    power_up((sim_ns_t)ticks * TICK_NS);
    return true;
}

static void take_frames(void)
{
    while (sim_bus_arrival(&sim.bus) == sim.now) {
        memcpy(received[arrived % RECEIVED_MAX], sim_bus_take(&sim.bus), HAL_BUS_FRAME_BYTES);
        ++arrived;
    }
}

static void advance_to(sim_ns_t time)
{
    sim_event_t event;
    sim.wake_at = time;
    do {
        event = sim_advance(&sim);
        if (event == SIM_EVENT_FRAME) {
            take_frames();
        }
    } while (event != SIM_EVENT_WAKE);
}

void port_pass_us(uint32_t us)
{
    advance_to(sim.now + sim_ns_from_us(us));
}

void port_set_line(uint8_t channel, bool high)
{
    if (channel == 0u && high != sim.line.contact) {
        sim_line_plan(&sim.line, sim.now);
        advance_to(sim.now);
    }
}

void port_place_axis(uint8_t axis, int32_t position_counts)
{
    if (axis == 0u) {
        sim_axis_place(&sim.axis, CHAIN.accel_mm_s2, position_counts * CHAIN.resolution_um,
                       sim.now);
    }
}

bool port_receive(uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if (taken == arrived) {
        return false;
    }
    memcpy(frame, received[taken % RECEIVED_MAX], HAL_BUS_FRAME_BYTES);
    ++taken;
    return true;
}
