/* The effect of whatever stage takes longer than believed: by a fixed, a uniform and an exponential
 * time, but never less than none. */
#include <math.h>

#include "effects/effect.h"

double effect_delay(const sim_effect_call_t *call, double delay_us)
{
    double jitter_us = sim_random_uniform(call->random, call->parameters[1]);
    double tail_us = sim_random_exponential(call->random, call->parameters[2]);
    return fmax(0.0, delay_us + call->parameters[0] + jitter_us + tail_us);
}
