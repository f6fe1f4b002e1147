/*
 * Where the linear axes stand for given rotary angles, and how that changes with every unknown.
 * The unknowns are an array: sphere (3), tip (3), then per axis two offsets, two tilts and the
 * zero, in mm and rad. Task.
 */
#ifndef COMP_KINEMATICS_CHAIN_H
#define COMP_KINEMATICS_CHAIN_H

#include "comp/kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    KINEMATICS_CHAIN_OFFSET = 0,
    KINEMATICS_CHAIN_TILT = 2,
    KINEMATICS_CHAIN_ZERO = 4
}; /* places within an axis's unknowns */

/* Index of the coordinate (0 X, 1 Y, 2 Z) that unknown `i` of an axis moves or turns about. */
int32_t kinematics_chain_coordinate(const kinematics_axis_t *axis, int32_t i);

/* Position of the linear axes in mm for `angle_deg` of the axes and `unknowns`. */
void kinematics_chain_position(const kinematics_machine_t *machine, const double *unknowns,
                               const double *angle_deg, double position_mm[3]);

/* The same, and its derivatives: slopes[k][i] of coordinate k by unknown i, in mm/mm and mm/rad. */
void kinematics_chain_slopes(const kinematics_machine_t *machine, const double *unknowns,
                             const double *angle_deg, double position_mm[3],
                             double slopes[3][KINEMATICS_UNKNOWNS_MAX]);

#ifdef __cplusplus
}
#endif

#endif
