/* What the cycle asks of the machine: turns, motions, touches. Only five_axis_cycle.c uses it. */
#ifndef API_FIVE_AXIS_REQUESTS_H
#define API_FIVE_AXIS_REQUESTS_H

#include <stdbool.h>

#include "api/five_axis_cycle.h"
#include "cycle/kinematics_cycle.h"

/* Carry out what is this side's work; false for what could not be done. */
bool five_axis_carry_out(sim_measure_kinematics_t *play, const kinematics_cycle_request_t *request);

#endif
