/* Effects on the PLC's scans. */
#include <math.h>
#include <stdbool.h>

#include "effects/effect.h"

double effect_scan_period(const sim_effect_call_t *call, double period_us)
{
    return period_us + call->parameters[0];
}

double effect_scan_jitter(const sim_effect_call_t *call, double late_us)
{
    if (sim_random_uniform(call->random, 1.0) < call->parameters[2]) {
        return late_us;
    }
    double tail_us = sim_random_exponential(call->random, call->parameters[1]);
    return late_us + sim_random_uniform(call->random, call->parameters[0]) + tail_us;
}

/* A scan that is left out, and those after it, is one that begins whole periods later. */
double effect_scan_overrun(const sim_effect_call_t *call, double late_us)
{
    bool   is_overrun = sim_random_uniform(call->random, 1.0) < call->parameters[0];
    double span_us = sim_random_uniform(call->random, call->parameters[2]);
    double by_us = call->parameters[1] + span_us;
    if (call->parameters[3] > 0.5) {
        by_us = ceil(by_us / call->scan_us) * call->scan_us;
    }
    return is_overrun ? late_us + by_us : late_us;
}

/* Between two ages, the image is now the one and now the other. */
double effect_input_image_delay(const sim_effect_call_t *call, double scans)
{
    return floor(scans + call->parameters[0] + sim_random_uniform(call->random, 1.0));
}

/*
 * The controller starts its motions on a scan, so that the edge falls about a point of the next,
 * or about one of two.
 */
double effect_scan_phase_lock(const sim_effect_call_t *call, double phase)
{
    double locked = call->parameters[0] + sim_random_normal(call->random, call->parameters[1]);
    if (sim_random_uniform(call->random, 1.0) < call->parameters[2]) {
        return phase; /* where it would have been */
    }
    if (sim_random_uniform(call->random, 1.0) < call->parameters[4]) {
        locked += call->parameters[3];
    }
    return locked - floor(locked);
}
