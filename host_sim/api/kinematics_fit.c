#include "api/kinematics_fit.h"

int sim_kinematics_fit(const kinematics_machine_t *machine, const kinematics_point_t *points,
                       int32_t n, kinematics_result_t *result)
{
    return kinematics_fit(machine, points, n, result);
}

int32_t sim_kinematics_recommend(const kinematics_machine_t *machine,
                                 const kinematics_point_t *points, int32_t n,
                                 const kinematics_travel_t *travel, int32_t max,
                                 kinematics_point_t *more, kinematics_result_t *after)
{
    return kinematics_recommend(machine, points, n, travel, max, more, after);
}

int sim_kinematics_circle(const double direction[3], int32_t axis, const kinematics_point_t *points,
                          int32_t n, kinematics_circle_t *circle)
{
    return kinematics_circle_fit(direction, axis, points, n, circle);
}
