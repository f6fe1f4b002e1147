/*
 * How a machine is switched on and left for the cycle, and what the cycle is told of it.
 * sim_measure_kinematics_open() is here. Only five_axis_cycle.c uses it.
 */
#ifndef API_FIVE_AXIS_SETUP_H
#define API_FIVE_AXIS_SETUP_H

#include "api/five_axis_cycle.h"
#include "cycle/kinematics_conditions.h"

/* The machine in the terms of the firmware, as it stands now. */
kinematics_cycle_machine_t five_axis_described(const sim_measure_kinematics_t *play);

#endif
