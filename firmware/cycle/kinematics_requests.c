#include "cycle/kinematics_requests.h"

static void copy(double *to, const double *from)
{
    for (uint8_t i = 0u; i < 3u; i++) {
        to[i] = from[i];
    }
}

kinematics_cycle_request_t *kinematics_request_begin(kinematics_cycle_t             *cycle,
                                                     kinematics_cycle_step_t         step,
                                                     kinematics_cycle_request_kind_t kind)
{
    cycle->request = (kinematics_cycle_request_t){.kind = kind};
    copy(cycle->request.angle_deg, cycle->stance.angle_deg);
    cycle->step = step;
    cycle->has_request = true;
    return &cycle->request;
}

void kinematics_request_probe_step(kinematics_cycle_t *cycle, const sphere_probe_step_t *motion)
{
    kinematics_cycle_request_t *request = kinematics_request_begin(
        cycle, cycle->step, motion->is_touch ? KINEMATICS_CYCLE_TOUCH : KINEMATICS_CYCLE_MOVE);
    copy(request->target_mm, motion->target_mm);
    copy(request->direction, motion->direction);
    request->stand_off_mm = kinematics_conditions_stand_off(&cycle->job);
    request->feed_mm_min = kinematics_conditions_watched_feed(&cycle->job);
}

void kinematics_request_leave(kinematics_cycle_t *cycle, kinematics_cycle_step_t step)
{
    kinematics_cycle_request_t *request;

    if (kinematics_conditions_has_retract_height(&cycle->job)) {
        request = kinematics_request_begin(cycle, step, KINEMATICS_CYCLE_RETRACT);
        request->retract_height_mm = cycle->job.settings.value[KINEMATICS_Q408_RETRACT_HEIGHT];
        request->feed_mm_min = kinematics_conditions_feed(&cycle->job);
        return;
    }
    request = kinematics_request_begin(cycle, step, KINEMATICS_CYCLE_MOVE);
    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        double above = (kinematics_conditions_contact(&cycle->job) +
                        kinematics_conditions_stand_off(&cycle->job)) *
                       cycle->tool_axis[i];
        request->target_mm[i] = cycle->expected_mm[i] + above;
    }
    request->feed_mm_min = kinematics_conditions_watched_feed(&cycle->job);
}

void kinematics_request_turn(kinematics_cycle_t *cycle, uint8_t axis)
{
    kinematics_cycle_request_t *request = kinematics_request_begin(
        cycle, KINEMATICS_STEP_TURN,
        kinematics_conditions_has_m_function(&cycle->job) ? KINEMATICS_CYCLE_TURN_BY_M_FUNCTION
                                                          : KINEMATICS_CYCLE_TURN);
    request->axis = (rotary_axis_t)axis;
    copy(request->from_angle_deg, cycle->sphere_deg);
    copy(request->sphere_mm, cycle->sphere_mm);
    request->stand_off_mm =
        kinematics_conditions_contact(&cycle->job) + kinematics_conditions_stand_off(&cycle->job);
    request->feed_mm_min = kinematics_conditions_feed(&cycle->job);
    request->m_function = cycle->job.machine.strobe_rot_ax_pos;
    request->follow = !kinematics_conditions_has_retract_height(&cycle->job);
}

void kinematics_request_preset(kinematics_cycle_t *cycle, kinematics_cycle_step_t step,
                               const double *angle_deg, const double *centre_mm)
{
    kinematics_cycle_request_t *request =
        kinematics_request_begin(cycle, step, KINEMATICS_CYCLE_SET_PRESET);
    copy(request->angle_deg, angle_deg);
    copy(request->sphere_mm, centre_mm);
}
