#include "sim.h"

#include "hal_edge_events.h"
#include "probe.h"

#define UM_PER_MM 1000.0
#define FINER     100.0
#define FINEST_UM 1.0e-3

double sim_change(sim_t *sim, sim_quantity_t quantity, double value)
{
    if (!sim_effects_reach(&sim->effects, quantity)) {
        return value;
    }
    sim_effect_call_t scene = {
        .chain = sim->chain,
        .touch = sim->touch,
        .now_us = sim_us_from_ns(sim->now),
        .scan_us = sim->scan.period_ns / SIM_NS_PER_US,
        .speed_um_us = sim_axis_speed_um_us(&sim->axis, sim->now),
    };
    return sim_effects_change(&sim->effects, &scene, quantity, value);
}

static sim_ns_t scan_lateness(void *context, int64_t number)
{
    sim_t *sim = context;
    sim_effects_begin_scan(&sim->effects, (uint64_t)number);
    return sim_ns_from_us(sim_change(sim, SIM_SCAN_START, 0.0));
}

static void boot_scan(sim_t *sim)
{
    double   period_us = sim_change(sim, SIM_SCAN_PERIOD, sim->chain->scan_us);
    double   period_ns = fmax(period_us, 1.0) * SIM_NS_PER_US;
    sim_ns_t phase = (sim_ns_t)sim_random_uniform(&sim->random, period_ns);

    sim_scan_init(&sim->scan, phase, period_ns, sim->now);
    if (sim_effects_reach(&sim->effects, SIM_SCAN_START)) {
        sim->scan.late = scan_lateness;
        sim->scan.latest = sim_ns_from_us(sim_effects_most_us(&sim->effects, SIM_SCAN_START)) + 1;
        sim->scan.context = sim;
    }
}

/* An encoder keeps its own lines: counts are so fine then that they do not round them again. */
static double count_um(const sim_t *sim)
{
    double believed_um = sim->chain->resolution_um;
    if (!sim_effects_reach(&sim->effects, SIM_READING)) {
        return believed_um;
    }
    return fmin(believed_um, fmax(believed_um / FINER, FINEST_UM));
}

void sim_boot(sim_t *sim, const sim_chain_t *chain, const sim_setting_t *settings, uint32_t count,
              uint64_t seed, uint64_t replicate, sim_ns_t now)
{

    *sim = (sim_t){
        .chain = chain,
        .now = now,
        .axis_at = SIM_NEVER,
        .edge_at = SIM_NEVER,
        .wake_at = SIM_NEVER,
        .filter_us = chain->filter_us,
        .seed = seed,
        .replicate = replicate,
        .ticks_time = 0,
        .tick_ps = (uint32_t)llrint(chain->tick_us * SIM_NS_PER_US * SIM_PS_PER_NS),
    };
    sim_effects_boot(&sim->effects, settings, count, seed, replicate);
    sim->count_um = count_um(sim);
    sim_random_begin(&sim->random, seed, replicate, UINT64_MAX, 0u);
    sim_axis_place(&sim->axis, chain->accel_mm_s2, 0.0, now);
    sim_line_reset(&sim->line, 0);
    boot_scan(sim);
    sim_bus_reset(&sim->bus);
}

void sim_begin_touch(sim_t *sim, const sim_touch_t *touch)
{
    sim->touch = touch;
    sim->off_line_um = touch->datum_um - rint(touch->datum_um / sim->count_um) * sim->count_um;
    sim->now = sim_touch_start(sim, touch);
    sim->start_delay = sim->now - sim_ns_from_s(touch->time_s);
    sim->axis_at = SIM_NEVER;
    sim->edge_at = SIM_NEVER;
    sim->wake_at = SIM_NEVER;
    sim_random_begin(&sim->random, sim->seed, sim->replicate, touch->touch, 0u);
    sim_effects_begin_touch(&sim->effects, touch->touch);

    double accel_mm_s2 = sim_change(sim, SIM_ACCEL, sim->chain->accel_mm_s2);
    sim->delay = 0; /* there is no probe on a bench */
    if (sim->chain->is_machine) {
        sim->delay = sim_ns_from_us(sim_change(sim, SIM_PROBE_DELAY, sim->chain->delay_us));
    }
    sim_axis_place(&sim->axis, accel_mm_s2, -touch->approach_mm * UM_PER_MM, sim->now);
    sim_line_reset(&sim->line, sim_ns_from_us(sim_change(sim, SIM_FILTER, sim->filter_us)));
    sim_bus_reset(&sim->bus);
    sim_scan_shift_back(&sim->scan); /* what binds a touch to the scan leaves others alone */
}

static sim_ns_t earliest(sim_ns_t a, sim_ns_t b)
{
    return a < b ? a : b;
}

static sim_ns_t latest(sim_ns_t a, sim_ns_t b)
{
    return a > b ? a : b;
}

bool sim_is_moving(const sim_t *sim)
{
    return sim->axis_at != SIM_NEVER;
}

int32_t sim_counts(const sim_t *sim, double position_um)
{
    double counts = position_um * (1.0 / sim->count_um);
    return (int32_t)lrint(fmax(-SIM_COUNTS_MAX, fmin(counts, SIM_COUNTS_MAX)));
}

/* When the contact opens because the present motion passes the trigger point. */
static sim_ns_t opening_time(const sim_t *sim)
{
    sim_ns_t crossing = sim_axis_crossing(&sim->axis, sim->pretravel_um);
    return crossing == SIM_NEVER ? SIM_NEVER : crossing + sim->delay;
}

/* When it closes: the probe triggers, and the link carries that to the connector. */
static sim_ns_t closing_time(sim_t *sim)
{
    sim->triggered_at = sim_axis_crossing(&sim->axis, sim->pretravel_um);
    if (sim->triggered_at == SIM_NEVER) {
        return SIM_NEVER;
    }
    sim_ns_t sent = sim->triggered_at + sim->delay;
    if (!sim->chain->is_machine || !sim_effects_reach(&sim->effects, SIM_LINK)) {
        return sent;
    }
    return sim_ns_from_us(sim_change(sim, SIM_LINK, sim_us_from_ns(sent)));
}

/* Pretravel of a new approach, from where the surface is believed to be; effects may take it below
 * 0 no more than the probe does. */
static double draw_pretravel_um(sim_t *sim)
{
    double pretravel_um = sim_probe_pretravel_um(sim->chain, sim->touch, &sim->rest, &sim->random);
    double surface_um = sim->touch->surface_um;
    if (!sim->chain->is_machine) {
        return surface_um;
    }
    double admitted_um =
        sim_probe_admitted_um(sim->chain, sim_change(sim, SIM_PRETRAVEL, pretravel_um));
    return admitted_um + sim_change(sim, SIM_SURFACE, surface_um);
}

void sim_move(sim_t *sim, double target_um, double feed_mm_min)
{
    bool is_approach = target_um > 0.0;

    sim_axis_move(&sim->axis, target_um, sim_change(sim, SIM_FEED, feed_mm_min), sim->now);
    sim->axis_at = sim_axis_standstill(&sim->axis);
    if (is_approach) {
        sim->closed_at = SIM_NEVER;
        sim->pretravel_um = draw_pretravel_um(sim);
    }
    if (is_approach != sim->line.contact) { /* else the motion leaves the contact as it is */
        sim_line_plan(&sim->line, is_approach ? closing_time(sim) : opening_time(sim));
    }
}

void sim_stop(sim_t *sim, sim_ns_t reaction)
{
    bool is_before_trigger =
        !sim->line.contact && sim->line.contact_at != SIM_NEVER && sim->triggered_at > sim->now;

    sim_axis_stop(&sim->axis, reaction, sim->now);
    sim->axis_at =
        latest(sim_axis_standstill(&sim->axis), sim->now); /* it may be at rest already */
    if (is_before_trigger) {
        sim_line_plan(&sim->line, closing_time(sim));
    }
}

/* A contact that has to come to rest first, or never does. */
static void delay_pin(sim_t *sim)
{
    double rest_us = sim_change(sim, SIM_CONTACT, 0.0);
    if (isinf(rest_us) || sim->line.pin_at == SIM_NEVER) {
        sim->line.pin_at = SIM_NEVER;
    } else {
        sim->line.pin_at += sim_ns_from_us(rest_us);
    }
}

static void change_contact(sim_t *sim)
{
    sim_line_toggle_contact(&sim->line);
    if (!sim->line.contact) {
        return;
    }
    sim->closed_at = earliest(sim->closed_at, sim->now);
    delay_pin(sim);
    if (sim->touch->pulse_us > 0.0) {
        sim_line_plan(&sim->line, sim->now + sim_ns_from_us(sim->touch->pulse_us));
    }
}

/* Let the pin change at another point of the scan. */
static void shift_scans(sim_t *sim)
{
    double period = sim->scan.period_ns;
    double phase = fmod((double)(sim->now - sim->scan.phase), period) / period;
    double wanted = sim_change(sim, SIM_SCAN_PHASE, phase);
    sim_scan_shift(&sim->scan, (sim_ns_t)((phase - wanted) * period));
}

/*
 * Latch stage: an edge on the armed pin calls the interrupt after latency + U(0, jitter) (step
 * 4).
 */
static void change_pin(sim_t *sim)
{
    sim_line_toggle_pin(&sim->line);
    if (sim->line.pin && sim->is_edge_armed && sim->edge_at == SIM_NEVER) {
        double jitter_us = sim_random_uniform(&sim->random, sim->chain->skip_jitter_us);
        double latency_us = sim->chain->skip_latency_us + jitter_us;
        sim->edge_at = sim->now + sim_ns_from_us(sim_change(sim, SIM_INTERRUPT, latency_us));
    }
    if (sim->line.pin && sim_effects_reach(&sim->effects, SIM_SCAN_PHASE)) {
        shift_scans(sim);
    }
}

/* Captured are the tick and the position that the axis has there. */
static sim_event_t run_edge_interrupt(sim_t *sim)
{
    sim->edge_at = SIM_NEVER;
    uint32_t ticks = (uint32_t)sim_stamp_ticks(sim, &sim->captured_later);
    hal_edge_on_latch(0u, ticks);
    sim->captured_later = 0;
    return SIM_EVENT_EDGE;
}

/*
 * What happens at one instant happens in the order of the chain: contact, pin, interrupt, scan,
 * the rest.
 */
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
        sim->is_scanning = next == sim->scan.next_at;
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
