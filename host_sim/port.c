#include "port.h"

#include <stddef.h>

#include "hal_axis.h"
#include "hal_bus.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "hal_edge.h"
#include "hal_error.h"
#include "hal_pulse.h"

#define CHANNELS 1u
#define AXES     1u

static _Thread_local sim_t             *bound;
static _Thread_local sim_pulse_input_t *bound_pulses;

void sim_port_bind(sim_t *sim)
{
    bound = sim;
}

void sim_port_bind_pulses(sim_pulse_input_t *input)
{
    bound_pulses = input;
}

uint32_t hal_clock_now_ticks(void)
{
    sim_ns_t later;
    return (uint32_t)(bound->is_scanning ? sim_stamp_ticks(bound, &later)
                                         : sim_clock_ticks(bound, bound->now));
}

uint32_t hal_clock_tick_ps(void)
{
    return bound->tick_ps;
}

int hal_edge_arm(const hal_edge_config_t *config)
{
    if (config->channel >= CHANNELS) {
        return HAL_ERR_CHANNEL;
    }
    if (config->active_low) { /* the simulated line is what the probe does, not a voltage */
        return HAL_ERR_CONFIG;
    }
    /* On top of the filter that the rig has in front of the pin. */
    double filter_us = bound->chain->filter_us + config->glitch_filter_us;
    bound->line.filter += sim_ns_from_us(filter_us - bound->filter_us);
    bound->filter_us = filter_us;
    bound->is_edge_armed = true;
    bound->edge_at = SIM_NEVER;
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel < CHANNELS) {
        bound->is_edge_armed = false;
        bound->edge_at = SIM_NEVER;
    }
}

bool hal_edge_level(uint8_t channel)
{
    return channel < CHANNELS && bound->line.pin;
}

/* The time of which the position is read. */
static sim_ns_t position_time(void)
{
    return sim_change_time(bound, SIM_POSITION_TIME, bound->now + bound->captured_later);
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    if (axis >= AXES) {
        return 0;
    }
    double position_um = sim_axis_position_um(&bound->axis, position_time());
    position_um = sim_change(bound, SIM_POSITION, position_um);
    position_um = sim_change(bound, SIM_READING, position_um);
    return sim_counts(bound, position_um + bound->off_line_um);
}

int hal_bus_send(const uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    sim_ns_t travel = 0;
    if (sim_bus_is_full(&bound->bus)) {
        return HAL_ERR_BUSY;
    }
    if (sim_bus_begins_burst(&bound->bus, bound->now)) {
        double jitter_us = sim_random_uniform(&bound->random, bound->chain->report_jitter_us);
        double travel_us = bound->chain->report_latency_us + jitter_us;
        travel = sim_ns_from_us(sim_change(bound, SIM_REPORT, travel_us));
    }
    sim_bus_send(&bound->bus, frame, travel, bound->now);
    return HAL_OK;
}

int hal_pulse_start(hal_pulse_edge_t edge)
{
    if (bound_pulses == NULL) {
        return HAL_ERR_CONFIG;
    }
    sim_pulse_input_start(bound_pulses, edge);
    return HAL_OK;
}

void hal_pulse_stop(void)
{
    if (bound_pulses != NULL) {
        sim_pulse_input_stop(bound_pulses);
    }
}

bool hal_pulse_take(hal_pulse_t *pulse)
{
    return bound_pulses != NULL && sim_pulse_input_take(bound_pulses, pulse);
}

/* Virtual time stands still while the firmware runs, so no interrupt can come in. */
hal_critical_state_t hal_critical_enter(void)
{
    return 0u;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    (void)saved;
}
