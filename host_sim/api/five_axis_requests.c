#include "api/five_axis_requests.h"

#include <math.h>

#include "api/five_axis_play.h"

#define S_PER_MIN 60.0
#define MOVE_S    1.0 /* of the virtual clock, for a motion of the linear axes */

/* A motion at the programmed feed; mm and degrees alike. */
static void take_time(sim_measure_kinematics_t *play, double way, double feed_per_min)
{
    play->duration_s += feed_per_min > 0.0 ? way / feed_per_min * S_PER_MIN : 0.0;
}

static double apart(const double a[3], const double b[3])
{
    double square = 0.0;
    for (int i = 0; i < 3; ++i) {
        square += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(square);
}

static void turn(sim_measure_kinematics_t *play, const kinematics_cycle_request_t *request)
{
    double sphere_mm[3];
    double goes_mm[3];
    double from_mm[3];
    double turns_deg = fabs(request->angle_deg[request->axis] - play->shown_deg[request->axis]);

    five_axis_copy(from_mm, play->position_mm);
    play->shown_deg[request->axis] = request->angle_deg[request->axis];
    five_axis_turn_back(&play->belief, request->from_angle_deg, request->sphere_mm, sphere_mm);
    five_axis_expect(&play->belief, sphere_mm, request->angle_deg, goes_mm);
    five_axis_turn(&play->rig, (int32_t)request->axis,
                   five_axis_encoder_deg(&play->belief, (int32_t)request->axis,
                                         request->angle_deg[request->axis]));
    five_axis_copy(play->input.centre_mm, goes_mm);
    five_axis_tool_axis(&play->belief, request->angle_deg, play->input.tool_axis);
    if (request->follow) {
        five_axis_ahead(goes_mm, play->input.tool_axis, request->stand_off_mm, play->position_mm);
    }
    take_time(play, fmax(turns_deg, apart(from_mm, play->position_mm)), request->feed_mm_min);
}

/* A straight motion that is watched: false if the ball strikes the sphere on its way. */
static bool move(sim_measure_kinematics_t *play, const double target_mm[3])
{
    double way[3];
    double length = 0.0;
    for (int i = 0; i < 3; ++i) {
        way[i] = target_mm[i] - play->position_mm[i];
        length += way[i] * way[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 3; ++i) {
        way[i] = length > 0.0 ? way[i] / length : 0.0;
    }
    double free_mm = length > 0.0 ? sim_machine_distance_mm(&play->truth, &play->rig.stance,
                                                            play->position_mm, way)
                                  : length;
    five_axis_copy(play->position_mm, target_mm);
    play->rig.touch.time_s += MOVE_S;
    return !(free_mm > 0.0 && free_mm < length);
}

static bool touch(sim_measure_kinematics_t *play, const kinematics_cycle_request_t *request)
{
    ++play->touches;
    five_axis_copy(play->position_mm, request->target_mm);
    bool touched =
        five_axis_touch(&play->rig, request->target_mm, request->direction,
                        request->stand_off_mm + play->control.search_mm, play->input.touched_mm);
    play->duration_s += touched ? play->rig.cycle_s : 0.0;
    return touched;
}

static void retract(sim_measure_kinematics_t *play, const kinematics_cycle_request_t *request)
{
    double from_mm[3];
    five_axis_copy(from_mm, play->position_mm);
    five_axis_copy(play->position_mm, play->preset_mm);
    /* Of the workpiece system, which has its zero there. */
    play->position_mm[2] += request->retract_height_mm;
    take_time(play, apart(from_mm, play->position_mm), request->feed_mm_min);
}

bool five_axis_carry_out(sim_measure_kinematics_t *play, const kinematics_cycle_request_t *request)
{
    switch (request->kind) {
    case KINEMATICS_CYCLE_CANCEL_ROTATION:
        play->is_rotation_cancelled = true;
        return true;
    case KINEMATICS_CYCLE_RETRACT:
        retract(play, request);
        return true;
    case KINEMATICS_CYCLE_TURN:
    case KINEMATICS_CYCLE_TURN_BY_M_FUNCTION:
        turn(play, request);
        return true;
    case KINEMATICS_CYCLE_MOVE:
        take_time(play, apart(request->target_mm, play->position_mm), request->feed_mm_min);
        return move(play, request->target_mm);
    case KINEMATICS_CYCLE_TOUCH:
        return touch(play, request);
    case KINEMATICS_CYCLE_SET_PRESET:
        five_axis_copy(play->preset_mm, request->sphere_mm);
        ++play->presets;
        return true;
    case KINEMATICS_CYCLE_TILT:
        five_axis_copy(play->tilt_deg, request->angle_deg);
        play->is_tilted = true;
        return true;
    default:
        return false;
    }
}
