/* Effects on the way of the report. */
#include <math.h>
#include <stdbool.h>

#include "effects/effect.h"

/* A longer way, and a queue whose length is exponential. */
double effect_report_delay(const sim_effect_call_t *call, double travel_us)
{
    double queue_us = -call->parameters[1] * log1p(-sim_random_uniform(call->random, 1.0));
    bool   is_direct = sim_random_uniform(call->random, 1.0) < call->parameters[2];
    queue_us = is_direct ? 0.0 : queue_us;
    return fmax(0.0, travel_us + call->parameters[0] + queue_us);
}
