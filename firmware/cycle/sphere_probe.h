/*
 * Probing a sphere: where the tip goes for one measurement of its centre and radius, and both from
 * the touched points. One touch along the tool axis, on the pole, then 3 to 8 around the equator,
 * in equal steps from the reference angle (Q380). All lengths in mm.
 */
#ifndef CYCLE_SPHERE_PROBE_H
#define CYCLE_SPHERE_PROBE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPHERE_TOUCHES_MIN 3 /* around the equator */
#define SPHERE_TOUCHES_MAX 8

typedef struct {
    double  centre_mm[3]; /* where it is expected */
    double  tool_axis[3]; /* from tip to spindle, length 1 */
    double  contact_mm;   /* radius of sphere and tip together, > 0 */
    double  stand_off_mm; /* start of a touch to the nominal surface, > 0 */
    double  reference_deg;
    uint8_t touches; /* around the equator */
} sphere_probe_config_t;

typedef struct {
    double target_mm[3];
    double direction[3]; /* of a touch, length 1 */
    bool   is_touch;     /* else a straight motion to the target */
} sphere_probe_step_t;

/* The fields are for this module. */
typedef struct {
    sphere_probe_config_t config;
    double                touched_mm[1 + SPHERE_TOUCHES_MAX][3]; /* pole first */
    double                in_plane[2][3]; /* unit vectors, reference angle 0° and 90° */
    uint8_t               step;
    uint8_t               touched;
} sphere_probe_t;

/* Begin a measurement; the tip stands above the sphere, or wherever a straight way leads there. */
void sphere_probe_start(sphere_probe_t *probe, const sphere_probe_config_t *config);

/* The next motion or touch; false after the last one. */
bool sphere_probe_next(sphere_probe_t *probe, sphere_probe_step_t *step);

/* The latched position of the touch given last. */
void sphere_probe_touched(sphere_probe_t *probe, const double *touched_mm);

/*
 * Centre, and radius of sphere and tip together, from all touches. The circle of least squares
 * around the tool axis, then the height below the pole: of the centre for the radius as configured,
 * which scatters less; the radius itself is that of the sphere through circle and pole. False if
 * the points lie on no sphere.
 */
bool sphere_probe_solve(const sphere_probe_t *probe, double *centre_mm, double *contact_mm);

#ifdef __cplusplus
}
#endif

#endif
