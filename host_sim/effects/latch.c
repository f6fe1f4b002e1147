/* Effects on the edge interrupt and on the device clock. */
#include <math.h>
#include <stdbool.h>

#include "effects/effect.h"

#define PPM 1.0e-6

double effect_isr_latency(const sim_effect_call_t *call, double latency_us)
{
    double jitter_us = sim_random_uniform(call->random, call->parameters[1]);
    return fmax(0.0, latency_us + call->parameters[0] + jitter_us);
}

/* An edge that falls into a masked stretch waits for the rest of it. */
double effect_isr_blocking(const sim_effect_call_t *call, double latency_us)
{
    bool is_masked = sim_random_uniform(call->random, 1.0) < call->parameters[0];
    return is_masked ? latency_us + sim_random_uniform(call->random, call->parameters[1])
                     : latency_us;
}

double effect_timer_quantisation(const sim_effect_call_t *call, double stamp_us)
{
    return floor(stamp_us / call->parameters[0]) * call->parameters[0];
}

double effect_timer_drift(const sim_effect_call_t *call, double master_us)
{
    return master_us * (1.0 + call->parameters[0] * PPM);
}
