/* Effects on the way of the report. */
#include <math.h>
#include <stdbool.h>

#include "effects/effect.h"

#define MM_PER_M 1000.0

/* A longer way, longer by the steps made meanwhile, and a queue whose length is exponential. */
double effect_report_delay(const sim_effect_call_t *call, double travel_us)
{
    double queue_us = sim_random_exponential(call->random, call->parameters[1]);
    bool   is_direct = sim_random_uniform(call->random, 1.0) < call->parameters[2];
    queue_us = is_direct ? 0.0 : queue_us;
    double feed_m_min = call->touch->feed_mm_min / MM_PER_M;
    double way_us = travel_us + call->parameters[0] + call->parameters[3] * feed_m_min;
    return fmax(0.0, way_us + queue_us);
}
