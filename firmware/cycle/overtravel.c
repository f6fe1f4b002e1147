#include "cycle/overtravel.h"

#include <math.h>

#define S_PER_MIN 60.0
#define UM_PER_MM 1000.0
#define US_PER_S  1.0e6

double overtravel_um(const overtravel_path_t *path, double feed_mm_min)
{
    double speed_mm_s = feed_mm_min / S_PER_MIN;
    double reaction_s = path->reaction_us / US_PER_S;
    return UM_PER_MM * speed_mm_s * (reaction_s + speed_mm_s / (2.0 * path->accel_mm_s2));
}

/* v = 2s / (t + √(t² + 2s/a)): the usual root, written so that nothing cancels when t is long. */
double overtravel_safe_feed_mm_min(const overtravel_path_t *path, double allowed_um)
{
    double allowed_mm = allowed_um / UM_PER_MM;
    double reaction_s = path->reaction_us / US_PER_S;
    double root_s = sqrt(reaction_s * reaction_s + 2.0 * allowed_mm / path->accel_mm_s2);
    double time_s = reaction_s + root_s; /* 0 as well for next to nothing, whose root vanishes */
    return allowed_mm > 0.0 && time_s > 0.0 ? S_PER_MIN * 2.0 * allowed_mm / time_s : 0.0;
}
