#include "sim.h"

#include <math.h>

#define START_LANE 128u /* of random numbers, between those of effects */
#define SECOND     ((sim_ns_t)SIM_NS_PER_S)
#define SLOWEST_NS (SECOND / 2) /* of a second: what waits for the clock has to end */
#define FASTEST_NS (SECOND * 2) /* and its picoseconds have to fit 64 bits after 100 days */

/* What the device clock shows at a time of the master clock. */
static sim_ns_t device_time(sim_t *sim, sim_ns_t time)
{
    if (!sim_effects_reach(&sim->effects, SIM_CLOCK)) {
        return time;
    }
    return sim_ns_from_us(sim_change(sim, SIM_CLOCK, sim_us_from_ns(time)));
}

sim_ns_t sim_change_time(sim_t *sim, sim_quantity_t quantity, sim_ns_t time)
{
    if (!sim_effects_reach(&sim->effects, quantity)) {
        return time;
    }
    double device_us = sim_us_from_ns(device_time(sim, time));
    return time + sim_ns_from_us(sim_change(sim, quantity, device_us) - device_us);
}

bool sim_clock_goes_on(sim_t *sim)
{
    if (!sim_effects_reach(&sim->effects, SIM_CLOCK)) {
        return true;
    }
    sim_ns_t shown = device_time(sim, sim->now + SECOND) - device_time(sim, sim->now);
    return shown >= SLOWEST_NS && shown <= FASTEST_NS;
}

/* The firmware asks several times at one instant, and a division of 64 bits is slow. */
uint64_t sim_clock_ticks(sim_t *sim, sim_ns_t time)
{
    if (time != sim->ticks_time) {
        sim->ticks_time = time;
        sim->ticks = (uint64_t)device_time(sim, time) * SIM_PS_PER_NS / sim->tick_ps;
    }
    return sim->ticks;
}

/* To the nanosecond at which the clock shows it: a PLC's scan falls just there now and then. */
sim_ns_t sim_time_after(sim_t *sim, uint32_t ticks)
{
    if (ticks == UINT32_MAX) {
        return SIM_NEVER;
    }
    uint64_t due = sim_clock_ticks(sim, sim->now) + (ticks > 0u ? ticks : 1u);
    uint64_t due_ns = (due * sim->tick_ps + SIM_PS_PER_NS - 1u) / SIM_PS_PER_NS;
    return sim->now + (sim_ns_t)due_ns - device_time(sim, sim->now);
}

void sim_wake_after(sim_t *sim, uint32_t ticks)
{
    sim->wake_at = sim_time_after(sim, ticks);
}

uint64_t sim_stamp_ticks(sim_t *sim, sim_ns_t *later)
{
    *later = 0;
    if (!sim_effects_reach(&sim->effects, SIM_CAPTURE)) {
        return sim_clock_ticks(sim, sim->now);
    }
    /* Unrounded: a clock that rounds otherwise does not round what was rounded down before. */
    double device_us = (double)device_time(sim, sim->now) / SIM_NS_PER_US;
    double ticks_per_us = SIM_PS_PER_NS * SIM_NS_PER_US / sim->tick_ps;
    double stamp_us = sim_change(sim, SIM_CAPTURE, device_us);
    double believed_us = floor(device_us * ticks_per_us) / ticks_per_us;
    *later = sim_ns_from_us(stamp_us - believed_us);
    int64_t ticks = (int64_t)floor(stamp_us * ticks_per_us);
    return (uint64_t)ticks; /* below 0 it wraps, as a clock does */
}

void sim_set_begins(sim_t *sim, const sim_controller_t *controller)
{
    sim->start_spread_us = controller->start_spread_us;
    if (controller->scan_phase_us > 0.0) {
        double later_us = sim_random_uniform(&sim->random, controller->scan_spread_us);
        double begin_ns = (controller->scan_phase_us + later_us) * SIM_NS_PER_US;
        sim->scan.phase = (sim_ns_t)fmod(ceil(begin_ns), sim->scan.period_ns);
        sim_scan_restart(&sim->scan, sim->now);
    }
}

sim_ns_t sim_touch_start(const sim_t *sim, const sim_touch_t *touch)
{
    sim_ns_t start = sim_ns_from_s(touch->time_s);
    if (sim->start_spread_us <= 0.0 || touch->path != SIM_PATH_PLC) {
        return start;
    }
    sim_random_t random;
    sim_random_begin(&random, sim->seed, sim->replicate, touch->touch, START_LANE);
    return start + (sim_ns_t)sim_random_uniform(&random, sim->start_spread_us * SIM_NS_PER_US);
}
