/*
 * Sphere centres at any positions of a five-axis machine's rotary axes, each by real touches of the
 * firmware. Python reads this header too: no more of the preprocessor than what can be left out.
 */
#ifndef API_FIVE_AXIS_POINTS_H
#define API_FIVE_AXIS_POINTS_H

#include <stdint.h>

#include "chain.h"
#include "five_axis.h"

#pragma GCC visibility push(default)

/* How each sphere is probed. */
typedef struct {
    double  feed_mm_min;   /* of the measuring touch */
    double  stand_off_mm;  /* start of a touch to the expected surface */
    double  search_mm;     /* a touch goes on so far past it */
    double  reference_deg; /* azimuth of the first touch around the equator */
    int32_t touches;       /* around the equator, 3 to 8; one more on the pole */
    int32_t path;          /* SIM_PATH_* */
} sim_probing_t;

/* One sphere: angles of A, B, C as told, and what was measured. */
typedef struct {
    double angle_deg[3];
    double centre_mm[3];
    double contact_mm; /* radius of sphere and tip together */
} sim_sphere_t;

/*
 * Probe the sphere at the angles of `spheres` (n) one after the other, A turned first, then B, then
 * C; expected by `believed`, whose errors are not looked at, from the sphere before. Returns how
 * many were measured: fewer than n when a touch failed; or the negative SIM_PLAY_ERR_… of what
 * cannot be played.
 */
int32_t sim_five_axis_points(const sim_rig_t *rig, const sim_machine_t *truth,
                             const sim_machine_t *believed, const sim_probing_t *probing,
                             sim_sphere_t *spheres, uint32_t n);

#pragma GCC visibility pop

#endif
