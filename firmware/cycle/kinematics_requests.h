/* What cycle 451 asks its caller for, filled in. Only kinematics_cycle.c and
 * kinematics_cycle_start.c use it. Task. */
#ifndef CYCLE_KINEMATICS_REQUESTS_H
#define CYCLE_KINEMATICS_REQUESTS_H

#include "cycle/kinematics_cycle.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Begin a request with the angles at which the axes are, or will be, and give the rest to fill. */
kinematics_cycle_request_t *kinematics_request_begin(kinematics_cycle_t             *cycle,
                                                     kinematics_cycle_step_t         step,
                                                     kinematics_cycle_request_kind_t kind);

/* A motion or a touch around the sphere. */
void kinematics_request_probe_step(kinematics_cycle_t *cycle, const sphere_probe_step_t *motion);

/* To the retract height, or above the pole of the sphere as it is expected. */
void kinematics_request_leave(kinematics_cycle_t *cycle, kinematics_cycle_step_t step);

/* An axis to where the stance has it already. */
void kinematics_request_turn(kinematics_cycle_t *cycle, uint8_t axis);

/* The preset to where the sphere was at these angles. */
void kinematics_request_preset(kinematics_cycle_t *cycle, kinematics_cycle_step_t step,
                               const double *angle_deg, const double *centre_mm);

#ifdef __cplusplus
}
#endif

#endif
