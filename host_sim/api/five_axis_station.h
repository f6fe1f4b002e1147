/* A station of the shared library's users in the firmware's terms. */
#ifndef API_FIVE_AXIS_STATION_H
#define API_FIVE_AXIS_STATION_H

#include "api/sim_station.h"
#include "cycle/kinematics_plan.h"

kinematics_station_t five_axis_station(const sim_station_t *from);

#endif
