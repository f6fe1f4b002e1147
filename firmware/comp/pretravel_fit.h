/*
 * Best-fit circle or sphere of trigger points: the centre that trigger radii are measured from.
 * Least squares of the distances to the surface (geometric, not algebraic); the centre is free.
 */
#ifndef COMP_PRETRAVEL_FIT_H
#define COMP_PRETRAVEL_FIT_H

#include <stdint.h>

#include "comp/pretravel.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where the centre of the tip was when the probe triggered. */
typedef struct {
    double x_um;
    double y_um;
    double z_um; /* along the probe's axis */
} pretravel_point_t;

/* How many coordinates of the centre are sought. */
typedef enum {
    PRETRAVEL_CIRCLE = 2, /* in x and y; z is ignored */
    PRETRAVEL_SPHERE = 3
} pretravel_shape_t;

typedef struct {
    double x_um;
    double y_um;
    double z_um; /* 0 for a circle */
    double radius_um;
    double scatter_um; /* of the radii about radius_um, root of the mean square */
} pretravel_fit_t;

/*
 * Fit n points. Task level.
 * Errors: FEW_POINTS (a circle wants 3, a sphere 4), NOT_FINITE, CENTRE: points on a line, on a
 * plane, or all in one place.
 */
int pretravel_fit(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                  pretravel_fit_t *fit);

/* Trigger radii of n points: their distances from the centre of the fit, in µm. */
void pretravel_radii_um(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                        const pretravel_fit_t *fit, double *radius_um);

#ifdef __cplusplus
}
#endif

#endif
