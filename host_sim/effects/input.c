/* Effects between the connector and the pin. */
#include <math.h>

#include "effects/effect.h"

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
