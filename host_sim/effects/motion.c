/* Effects on the motion of the axis. */
#include <math.h>

#include "effects/effect.h"

#define SLOWEST_MM_MIN 1.0

double effect_feed_error(const sim_effect_call_t *call, double feed_mm_min)
{
    double limit_mm_min = call->parameters[2] > 0.0 ? call->parameters[2] : INFINITY;
    double real_mm_min = feed_mm_min * (1.0 + call->parameters[0] / 100.0) + call->parameters[1];
    return fmax(SLOWEST_MM_MIN, fmin(real_mm_min, limit_mm_min));
}

double effect_unfinished_acceleration(const sim_effect_call_t *call, double accel_mm_s2)
{
    return accel_mm_s2 * call->parameters[0];
}
