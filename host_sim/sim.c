#include "sim.h"

#include "hal_edge_events.h"
#include "probe.h"

#define UM_PER_MM 1000.0

void sim_boot(sim_t *sim, const sim_chain_t *chain, uint64_t seed, uint64_t replicate, sim_ns_t now)
{
    sim_ns_t period = sim_ns_from_us(chain->scan_us);

    *sim = (sim_t){
        .chain = chain,
        .now = now,
        .axis_at = SIM_NEVER,
        .edge_at = SIM_NEVER,
        .wake_at = SIM_NEVER,
        .delay = sim_ns_from_us(chain->delay_us),
        .seed = seed,
        .replicate = replicate,
        .counts_per_um = 1.0 / chain->resolution_um,
        .ticks_time = 0,
        .tick_ps = (uint32_t)llrint(chain->tick_us * SIM_NS_PER_US * SIM_PS_PER_NS),
    };
    sim_random_begin(&sim->random, seed, replicate, UINT64_MAX);
    sim_ns_t phase = (sim_ns_t)sim_random_uniform(&sim->random, (double)period);
    sim_scan_init(&sim->scan, phase, period, now);
    sim_axis_place(&sim->axis, chain->accel_mm_s2, 0.0, now);
    sim_line_reset(&sim->line, sim_ns_from_us(chain->filter_us));
    sim_bus_reset(&sim->bus);
}

sim_ns_t sim_touch_start(const sim_touch_t *touch)
{
    return (sim_ns_t)llrint(touch->time_s * SIM_NS_PER_S);
}

void sim_begin_touch(sim_t *sim, const sim_touch_t *touch)
{
    sim->touch = touch;
    sim->now = sim_touch_start(touch);
    sim->axis_at = SIM_NEVER;
    sim->edge_at = SIM_NEVER;
    sim->wake_at = SIM_NEVER;
    sim_random_begin(&sim->random, sim->seed, sim->replicate, touch->touch);
    sim_axis_place(&sim->axis, sim->chain->accel_mm_s2, -touch->approach_mm * UM_PER_MM, sim->now);
    sim_line_reset(&sim->line, sim->line.filter);
    sim_bus_reset(&sim->bus);
}

/* The firmware asks several times at one instant, and a division of 64 bits is slow. */
uint64_t sim_clock_ticks(sim_t *sim, sim_ns_t time)
{
    if (time != sim->ticks_time) {
        sim->ticks_time = time;
        sim->ticks = (uint64_t)time * SIM_PS_PER_NS / sim->tick_ps;
    }
    return sim->ticks;
}

sim_ns_t sim_time_after(const sim_t *sim, uint32_t ticks)
{
    if (ticks == UINT32_MAX) {
        return SIM_NEVER;
    }
    /* A tick more than asked for, as part of the present one is over. */
    return sim->now + (sim_ns_t)(((uint64_t)ticks + 1u) * sim->tick_ps / SIM_PS_PER_NS);
}

void sim_wake_after(sim_t *sim, uint32_t ticks)
{
    sim->wake_at = sim_time_after(sim, ticks);
}

bool sim_is_moving(const sim_t *sim)
{
    return sim->axis_at != SIM_NEVER;
}

/* When the contact closes or opens because the present motion passes the trigger point. */
static sim_ns_t trigger_time(const sim_t *sim)
{
    sim_ns_t crossing = sim_axis_crossing(&sim->axis, sim->pretravel_um);
    return crossing == SIM_NEVER ? SIM_NEVER : crossing + sim->delay;
}

void sim_move(sim_t *sim, double target_um, double feed_mm_min)
{
    bool is_approach = target_um > 0.0;

    sim_axis_move(&sim->axis, target_um, feed_mm_min, sim->now);
    sim->axis_at = sim_axis_standstill(&sim->axis);
    if (is_approach) {
        sim->closed_at = SIM_NEVER;
        sim->pretravel_um = sim_probe_pretravel_um(sim->chain, sim->touch, &sim->random);
    }
    if (is_approach != sim->line.contact) { /* else the motion leaves the contact as it is */
        sim_line_plan(&sim->line, trigger_time(sim));
    }
}

void sim_stop(sim_t *sim, sim_ns_t reaction)
{
    bool is_before_trigger = !sim->line.contact && sim->line.contact_at != SIM_NEVER &&
                             sim->line.contact_at - sim->delay > sim->now;

    sim_axis_stop(&sim->axis, reaction, sim->now);
    sim->axis_at = sim_axis_standstill(&sim->axis);
    if (is_before_trigger) {
        sim_line_plan(&sim->line, trigger_time(sim));
    }
}

static sim_ns_t earliest(sim_ns_t a, sim_ns_t b)
{
    return a < b ? a : b;
}

static void change_contact(sim_t *sim)
{
    sim_line_toggle_contact(&sim->line);
    if (!sim->line.contact) {
        return;
    }
    sim->closed_at = earliest(sim->closed_at, sim->now);
    if (sim->touch->pulse_us > 0.0) {
        sim_line_plan(&sim->line, sim->now + sim_ns_from_us(sim->touch->pulse_us));
    }
}

/* Latch stage: an edge on the armed pin calls the interrupt after latency + U(0, jitter) (step 4). */
static void change_pin(sim_t *sim)
{
    sim_line_toggle_pin(&sim->line);
    if (sim->line.pin && sim->is_edge_armed && sim->edge_at == SIM_NEVER) {
        double jitter_us = sim_random_uniform(&sim->random, sim->chain->skip_jitter_us);
        sim->edge_at = sim->now + sim_ns_from_us(sim->chain->skip_latency_us + jitter_us);
    }
}

static sim_event_t run_edge_interrupt(sim_t *sim)
{
    sim->edge_at = SIM_NEVER;
    hal_edge_on_latch(0u, (uint32_t)sim_clock_ticks(sim, sim->now));
    return SIM_EVENT_EDGE;
}

/* What happens at one instant happens in the order of the chain: contact, pin, interrupt, scan, the rest. */
sim_event_t sim_advance(sim_t *sim)
{
    for (;;) {
        sim_ns_t input = earliest(sim->line.contact_at, sim->line.pin_at);
        sim_ns_t firmware = earliest(earliest(sim->edge_at, sim->scan.next_at), sim->wake_at);
        sim_ns_t frame = sim_bus_arrival(&sim->bus);
        sim_ns_t next = earliest(earliest(input, firmware), earliest(sim->axis_at, frame));

        if (next == SIM_NEVER) {
            return SIM_EVENT_NONE;
        }
        sim->now = next;
        if (next == sim->line.contact_at) {
            change_contact(sim);
        } else if (next == sim->line.pin_at) {
            change_pin(sim);
            return SIM_EVENT_LEVEL;
        } else if (next == sim->edge_at) {
            return run_edge_interrupt(sim);
        } else if (next == sim->scan.next_at) {
            return SIM_EVENT_SCAN;
        } else if (next == sim->axis_at) {
            sim->axis_at = SIM_NEVER;
            return SIM_EVENT_AXIS;
        } else if (next == sim->wake_at) {
            sim->wake_at = SIM_NEVER;
            return SIM_EVENT_WAKE;
        } else {
            return SIM_EVENT_FRAME;
        }
    }
}
