#include "api/five_axis_station.h"

#include <string.h>

kinematics_station_t five_axis_station(const sim_station_t *from)
{
    kinematics_station_t station = {
        .axis = (uint8_t)from->axis,
        .serves = (uint8_t)from->serves,
        .approach = (int8_t)from->approach,
        .is_reference = from->is_reference != 0,
        .is_second = from->is_second != 0,
        .radius_mm = from->radius_mm,
    };
    memcpy(station.angle_deg, from->angle_deg, sizeof station.angle_deg);
    memcpy(station.centre_mm, from->centre_mm, sizeof station.centre_mm);
    return station;
}
