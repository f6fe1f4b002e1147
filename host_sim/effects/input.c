/* Effects between the connector and the pin. */
#include <math.h>

#include "effects/effect.h"

double effect_input_filter(const sim_effect_call_t *call, double filter_us)
{
    double jitter_us = sim_random_uniform(call->random, call->parameters[1]);
    double tail_us = sim_random_exponential(call->random, call->parameters[2]);
    return fmax(0.0, filter_us + call->parameters[0] + jitter_us + tail_us);
}

/* The contact opens again and again until it rests, which begins late by a least, an exponential
 * and a uniform time. */
double effect_contact_bounce(const sim_effect_call_t *call, double rest_us)
{
    if (sim_random_uniform(call->random, 1.0) >= call->parameters[0]) {
        return rest_us;
    }
    double exponential_us = sim_random_exponential(call->random, call->parameters[1]);
    double uniform_us = sim_random_uniform(call->random, call->parameters[3]);
    return rest_us + call->parameters[2] + exponential_us + uniform_us;
}

double effect_lost_trigger(const sim_effect_call_t *call, double rest_us)
{
    return sim_random_uniform(call->random, 1.0) < call->parameters[0] ? INFINITY : rest_us;
}
