/* Effects on the edge interrupt and on the device clock. */
#include <math.h>
#include <stddef.h>

#include "effects/effect.h"

#define PPM           1.0e-6
#define US_PER_H      3.6e9
#define US_PER_S      1.0e6
#define CALIBRATION_C 20.0
#define ROUNDING      1.0e-3 /* nominal ticks */

/* An edge that falls into a masked stretch waits for the rest of it; of stretches whose lengths
 * differ the rest has a tail. One that the edge itself starts, as another interrupt of it, is
 * waited for from its begin. */
double effect_isr_blocking(const sim_effect_call_t *call, double latency_us)
{
    if (sim_random_uniform(call->random, 1.0) >= call->parameters[0]) {
        return latency_us;
    }
    double rest_us = sim_random_uniform(call->random, call->parameters[1]);
    double tail_us = sim_random_exponential(call->random, call->parameters[2]);
    return latency_us + call->parameters[3] + rest_us + tail_us;
}

/* This and the chain round down: a stamp on a tick must not fall short of it by its last bits. */
double effect_timer_quantisation(const sim_effect_call_t *call, double stamp_us)
{
    double tick_us = call->parameters[0];
    double slack_us = ROUNDING * call->chain->tick_us;
    double lead_us = 0.5 * tick_us * call->parameters[2] + slack_us;
    return floor((stamp_us + lead_us) / tick_us) * tick_us + call->parameters[1] + slack_us;
}

/* Kelvins above the calibration times seconds, from the start on; the temperature of a touch is
 * that of the time since the touch before. */
static double warmth_k_s(const sim_effect_call_t *call, double master_us)
{
    double *since_s = &call->state[0];
    double *so_far_k_s = &call->state[1];
    double  warmth_k = call->touch->temp_c - CALIBRATION_C;

    *so_far_k_s += warmth_k * (call->touch->time_s - *since_s);
    *since_s = call->touch->time_s;
    return *so_far_k_s + warmth_k * (master_us / US_PER_S - *since_s);
}

double effect_timer_drift(const sim_effect_call_t *call, double master_us)
{
    double ppm = call->parameters[0] + call->parameters[1] * master_us / US_PER_H;
    double warm_us = call->touch == NULL ? 0.0 : call->parameters[2] * warmth_k_s(call, master_us);
    return master_us * (1.0 + ppm * PPM) + warm_us;
}
