/* Effects on the motion of the axis. */
#include <math.h>

#include "effects/effect.h"

#define SLOWEST_MM_MIN 1.0
#define LEAST_RATIO    0.001
#define MM_PER_M       1000.0

double effect_feed_error(const sim_effect_call_t *call, double feed_mm_min)
{
    double limit_mm_min = call->parameters[2] > 0.0 ? call->parameters[2] : INFINITY;
    double real_mm_min = feed_mm_min * (1.0 + call->parameters[0] / 100.0) + call->parameters[1];
    return fmax(SLOWEST_MM_MIN, fmin(real_mm_min, limit_mm_min));
}

double effect_unfinished_acceleration(const sim_effect_call_t *call, double accel_mm_s2)
{
    double feed_m_min = call->touch->feed_mm_min / MM_PER_M;
    double ratio = call->parameters[0] * pow(feed_m_min, call->parameters[1]);
    return accel_mm_s2 * fmax(LEAST_RATIO, fmin(ratio, 1.0));
}
