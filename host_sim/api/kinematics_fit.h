/*
 * firmware/comp/kinematics for users of the shared library; the contract is that of kinematics.h.
 * Python reads this header too: no more of the preprocessor than what can be left out.
 */
#ifndef API_KINEMATICS_FIT_H
#define API_KINEMATICS_FIT_H

#include <stdint.h>

#include "comp/kinematics.h"
#include "comp/kinematics_circle.h"

#pragma GCC visibility push(default)

int sim_kinematics_fit(const kinematics_machine_t *machine, const kinematics_point_t *points,
                       int32_t n, kinematics_result_t *result);

int32_t sim_kinematics_recommend(const kinematics_machine_t *machine,
                                 const kinematics_point_t *points, int32_t n,
                                 const kinematics_travel_t *travel, int32_t max,
                                 kinematics_point_t *more, kinematics_result_t *after);

int sim_kinematics_circle(const double direction[3], int32_t axis, const kinematics_point_t *points,
                          int32_t n, kinematics_circle_t *circle);

#pragma GCC visibility pop

#endif
