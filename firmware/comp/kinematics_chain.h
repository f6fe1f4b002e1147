/*
 * Where the linear axes stand for given rotary angles, and how that changes with every unknown.
 * The unknowns are an array: sphere (3), tip (3), then per axis two offsets, two tilts and the
 * zero, in mm and rad. Task.
 */
#ifndef COMP_KINEMATICS_CHAIN_H
#define COMP_KINEMATICS_CHAIN_H

#include "comp/kinematics.h"

enum { CHAIN_OFFSET = 0, CHAIN_TILT = 2, CHAIN_ZERO = 4 }; /* places within an axis's unknowns */

/* Index of the coordinate (0 X, 1 Y, 2 Z) that unknown `i` of an axis moves or turns about. */
int32_t chain_coordinate(const kinematics_axis_t *axis, int32_t i);

/* Position of the linear axes in mm for `angle_deg` of the axes and `unknowns`. */
void chain_position(const kinematics_machine_t *machine, const double *unknowns,
                    const double *angle_deg, double position_mm[3]);

/* The same, and its derivatives: slopes[k][i] of coordinate k by unknown i, in mm/mm and mm/rad. */
void chain_slopes(const kinematics_machine_t *machine, const double *unknowns,
                  const double *angle_deg, double position_mm[3],
                  double slopes[3][KINEMATICS_UNKNOWNS_MAX]);

#endif
