/* A station of the shared library's users in the firmware's terms. */
#ifndef PROGRAMS_FIVE_AXIS_STATION_H
#define PROGRAMS_FIVE_AXIS_STATION_H

#include "cycle/kinematics_plan.h"
#include "programs/sim_station.h"

kinematics_station_t five_axis_station(const sim_station_t *from);

#endif
