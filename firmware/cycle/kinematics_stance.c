#include "cycle/kinematics_stance.h"

#include <math.h>

/* By which side an axis is to come to the next station. */
static double wanted_side(const kinematics_plan_t *plan, uint8_t axis)
{
    const kinematics_station_t *next = &plan->stations[plan->measured];
    bool                        is_turned = next->axis == axis && next->is_second;
    return is_turned ? -plan->side_deg[axis] : plan->side_deg[axis];
}

static bool is_ready(const kinematics_stance_t *stance, const kinematics_plan_t *plan, uint8_t axis)
{
    double target_deg = plan->stations[plan->measured].angle_deg[axis];
    double side_deg = wanted_side(plan, axis);
    bool   came_so = fabs(side_deg) <= 0.0 || stance->side_deg[axis] * side_deg > 0.0;
    return came_so && kinematics_plan_is_there(stance->angle_deg[axis], target_deg);
}

bool kinematics_stance_is_at(const kinematics_stance_t *stance, const kinematics_plan_t *plan)
{
    bool ready = true;
    for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
        ready = ready && is_ready(stance, plan, axis);
    }
    return ready;
}

static void turn(kinematics_stance_t *stance, const kinematics_plan_t *plan, uint8_t axis)
{
    double target_deg = plan->stations[plan->measured].angle_deg[axis];
    double side_deg = wanted_side(plan, axis);
    bool   stands_before = fabs(side_deg) <= 0.0 ||
                           kinematics_plan_is_there(stance->angle_deg[axis], target_deg - side_deg);
    stance->angle_deg[axis] = stands_before ? target_deg : target_deg - side_deg;
    stance->side_deg[axis] = stands_before ? side_deg : 0.0;
}

bool kinematics_stance_turn(kinematics_stance_t *stance, const kinematics_plan_t *plan,
                            uint8_t *axis)
{
    for (*axis = 0u; *axis < ROTARY_AXES; ++*axis) {
        if (!is_ready(stance, plan, *axis)) {
            turn(stance, plan, *axis);
            return true;
        }
    }
    return false;
}
