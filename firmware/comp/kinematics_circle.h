/*
 * One rotary axis in closed form. While it alone turns, the reading at the sphere's centre runs
 * round a circle: in the plane normal to the axis p = c + r·e^{iθ}, linear in c and r because the
 * angles are known. Variance of each coordinate of c and of r: σ²·N/(N² − |Σ e^{iθ}|²), with σ from
 * the 2N − 4 residuals in the plane. The axial coordinate, a plane over the circle, tells the tilt.
 * Python reads this header too.
 */
#ifndef COMP_KINEMATICS_CIRCLE_H
#define COMP_KINEMATICS_CIRCLE_H

#include "comp/kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    double  centre_mm[3]; /* machine coordinates; along the axis the mean of the positions */
    double  radius_mm;
    double  direction[3];       /* of the axis as found, a unit vector */
    int32_t direction_is_known; /* three positions and a circle; else it is the believed one */
    double  scatter_mm;         /* σ of a coordinate in the plane; 0 with two positions */
    double  uncertainty_mm;     /* standard uncertainty of a coordinate of the centre and of the
                                   radius, widened like those of kinematics.h */
} kinematics_circle_t;

/*
 * Fit `n` points while the axis of index `axis` in angle_deg turns about the believed `direction`,
 * a unit vector. Returns KINEMATICS_OK, KINEMATICS_ERR_POINT for a value that is not finite or
 * KINEMATICS_ERR_TOO_FEW when all angles lie within about 0.01°. Task.
 */
int kinematics_circle_fit(const double direction[3], int32_t axis, const kinematics_point_t *points,
                          int32_t n, kinematics_circle_t *circle);

#ifdef __cplusplus
}
#endif

#endif
