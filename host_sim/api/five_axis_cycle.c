#include "api/five_axis_cycle.h"

#include <math.h>
#include <stdlib.h>

#include "api/batch.h"
#include "api/five_axis_belief.h"
#include "api/five_axis_rig.h"
#include "api/five_axis_station.h"
#include "cycle/kinematics_cycle.h"

#define S_PER_MIN 60.0
#define MOVE_S    1.0 /* of the virtual clock, for a motion of the linear axes */

struct sim_451 {
    five_axis_rig_t          rig;
    sim_machine_t            truth;
    five_axis_belief_t       belief;
    sim_chain_t              chain;
    sim_control_t            control;
    kinematics_settings_t    settings;
    kinematics_cycle_t       cycle;
    kinematics_cycle_input_t input;
    double                   position_mm[3];
    double                   preset_mm[3];
    double                   shown_deg[3]; /* what the control shows */
    double                   change_mm;
    double                   tilt_deg[3];
    int32_t                  presets;
    int64_t                  touches;
    double                   duration_s; /* of the motions as programmed, and of the touches */
    bool                     is_started;
    bool                     is_tilted;
    bool                     is_rotation_cancelled;
};

static void copy(double to[3], const double from[3])
{
    for (int i = 0; i < 3; ++i) {
        to[i] = from[i];
    }
}

/* `reading` + `by` · direction. */
static void ahead(const double from[3], const double direction[3], double by, double to[3])
{
    for (int i = 0; i < 3; ++i) {
        to[i] = from[i] + by * direction[i];
    }
}

void sim_451_believe(sim_451_t *play, const sim_machine_t *believed)
{
    five_axis_believe(&play->belief, believed);
}

/* The encoder goes to where the control, by its datum, shows `shown_deg`. */
static void turn_axis(sim_451_t *play, int32_t axis, double shown_deg)
{
    five_axis_turn(&play->rig, axis, five_axis_encoder_deg(&play->belief, axis, shown_deg));
}

/* A motion at the programmed feed; mm and degrees alike. */
static void take_time(sim_451_t *play, double way, double feed_per_min)
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

static void turn(sim_451_t *play, const kinematics_cycle_request_t *request)
{
    double sphere_mm[3];
    double goes_mm[3];
    double from_mm[3];
    double turns_deg = fabs(request->angle_deg[request->axis] - play->shown_deg[request->axis]);

    copy(from_mm, play->position_mm);
    play->shown_deg[request->axis] = request->angle_deg[request->axis];
    five_axis_turn_back(&play->belief, request->from_angle_deg, request->sphere_mm, sphere_mm);
    five_axis_expect(&play->belief, sphere_mm, request->angle_deg, goes_mm);
    turn_axis(play, (int32_t)request->axis, request->angle_deg[request->axis]);
    copy(play->input.centre_mm, goes_mm);
    five_axis_tool_axis(&play->belief, request->angle_deg, play->input.tool_axis);
    if (request->follow) {
        ahead(goes_mm, play->input.tool_axis, request->stand_off_mm, play->position_mm);
    }
    take_time(play, fmax(turns_deg, apart(from_mm, play->position_mm)), request->feed_mm_min);
}

/* A straight motion that is watched: false if the ball strikes the sphere on its way. */
static bool move(sim_451_t *play, const double target_mm[3])
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
    copy(play->position_mm, target_mm);
    play->rig.touch.time_s += MOVE_S;
    return !(free_mm > 0.0 && free_mm < length);
}

static bool touch(sim_451_t *play, const kinematics_cycle_request_t *request)
{
    ++play->touches;
    copy(play->position_mm, request->target_mm);
    bool touched =
        five_axis_touch(&play->rig, request->target_mm, request->direction,
                        request->stand_off_mm + play->control.search_mm, play->input.touched_mm);
    play->duration_s += touched ? play->rig.cycle_s : 0.0;
    return touched;
}

static void retract(sim_451_t *play, const kinematics_cycle_request_t *request)
{
    double from_mm[3];
    copy(from_mm, play->position_mm);
    copy(play->position_mm, play->preset_mm);
    /* Of the workpiece system, which has its zero there. */
    play->position_mm[2] += request->retract_height_mm;
    take_time(play, apart(from_mm, play->position_mm), request->feed_mm_min);
}

/* Carry out what is this side's work; false for what could not be done. */
static bool carry_out(sim_451_t *play, const kinematics_cycle_request_t *request)
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
        copy(play->preset_mm, request->sphere_mm);
        ++play->presets;
        return true;
    case KINEMATICS_CYCLE_TILT:
        copy(play->tilt_deg, request->angle_deg);
        play->is_tilted = true;
        return true;
    default:
        return false;
    }
}

/* What the caller answers, or SIM_451_FAILED for what is answered here. */
static int asked(const kinematics_cycle_request_t *request)
{
    switch (request->kind) {
    case KINEMATICS_CYCLE_EVALUATE:
        return SIM_451_EVALUATE;
    case KINEMATICS_CYCLE_ACKNOWLEDGE:
        return SIM_451_ACKNOWLEDGE;
    case KINEMATICS_CYCLE_APPLY:
        return SIM_451_APPLY;
    case KINEMATICS_CYCLE_CLEAR:
        return SIM_451_CLEAR;
    default:
        return SIM_451_FAILED;
    }
}

static int run_on(sim_451_t *play)
{
    kinematics_cycle_request_t request;
    while (kinematics_cycle_poll(&play->cycle, &play->input) == KINEMATICS_CYCLE_RUNNING) {
        if (!kinematics_cycle_take_request(&play->cycle, &request)) {
            play->input.outcome = KINEMATICS_CYCLE_CARRIED_OUT;
            continue;
        }
        int question = asked(&request);
        if (question != SIM_451_FAILED) {
            play->change_mm = request.change_mm;
            return question;
        }
        play->input.outcome =
            carry_out(play, &request) ? KINEMATICS_CYCLE_CARRIED_OUT : KINEMATICS_CYCLE_IMPOSSIBLE;
    }
    return play->cycle.state == KINEMATICS_CYCLE_DONE ? SIM_451_DONE : SIM_451_FAILED;
}

static bool is_in(const int32_t list[3], int32_t axis)
{
    return list[0] == axis || list[1] == axis || list[2] == axis;
}

static bool is_stacked(const sim_machine_t *machine)
{
    return machine->table[1] >= 0 || machine->head[1] >= 0;
}

static kinematics_cycle_machine_t description(const sim_451_t *play)
{
    const sim_control_t       *control = &play->control;
    kinematics_cycle_machine_t machine = {
        .tip_radius_mm = control->tip_radius_mm,
        .set_up_mm = control->set_up_mm,
        .probe_feed_max_mm_min = control->probe_feed_max_mm_min,
        .rapid_mm_min = control->rapid_mm_min,
        .tool_feed_mm_min = control->tool_feed_mm_min,
        .global_feed_mm_min = control->global_feed_mm_min,
        .global_clearance_mm = control->global_clearance_mm,
        .max_modification_mm = control->max_modification_mm,
        .max_dev_cal_ball_mm = control->max_dev_cal_ball_mm,
        .strobe_rot_ax_pos = control->strobe_rot_ax_pos,
        .has_kinematics_opt = control->has_kinematics_opt != 0,
        .has_kinematics_comp = control->has_kinematics_comp != 0,
        .has_advanced_functions_2 = control->has_advanced_functions_2 != 0,
        .is_tcpm_on = control->is_tcpm_on != 0,
        .is_turning = control->is_turning != 0,
        .is_stacked = is_stacked(&play->belief.machine),
        .grid = play->belief.grid,
    };
    copy(machine.position_mm, play->position_mm);
    copy(machine.preset_mm, play->preset_mm);
    copy(machine.angle_deg, control->start_deg);
    five_axis_tool_axis(&play->belief, machine.angle_deg, machine.tool_axis);
    for (int32_t i = 0; i < SIM_ROTARIES; ++i) {
        machine.axes[i].is_present =
            is_in(play->belief.machine.table, i) || is_in(play->belief.machine.head, i);
        machine.axes[i].grid_deg = control->hirth_deg[i];
    }
    return machine;
}

/* The operator puts the tip above the preset. */
static void stand_above(sim_451_t *play)
{
    double up[3];
    double above_mm =
        play->truth.sphere_radius_mm + play->control.tip_radius_mm + play->control.start_above_mm;
    five_axis_tool_axis(&play->belief, play->control.start_deg, up);
    ahead(play->preset_mm, up, above_mm, play->position_mm);
}

/* The operator turns the axes to where the program begins, sets the preset and puts the tip above
 * the sphere. */
static void prepare(sim_451_t *play)
{
    for (int32_t i = 0; i < SIM_ROTARIES; ++i) {
        turn_axis(play, i, play->control.start_deg[i]);
        play->shown_deg[i] = play->control.start_deg[i];
    }
    five_axis_concentric(&play->truth, &play->rig.stance, play->preset_mm);
    ahead(play->preset_mm, play->control.preset_miss_mm, 1.0, play->preset_mm);
    stand_above(play);
}

void sim_451_keep_preset(sim_451_t *play, const double sphere_mm[3])
{
    five_axis_expect(&play->belief, sphere_mm, play->control.start_deg, play->preset_mm);
    kinematics_settings_reset(&play->settings, KINEMATICS_COMPENSATE_PRESET);
    stand_above(play);
}

void sim_451_measure_grid(sim_451_t *play)
{
    kinematics_settings_reset(&play->settings, KINEMATICS_MEASURE_GRID);
}

/* What the firmware does not check itself; false for a NaN as well. */
static bool is_control(const sim_control_t *control)
{
    bool finite = true;
    for (int i = 0; i < 3; ++i) {
        finite = finite && isfinite(control->start_deg[i]) && isfinite(control->preset_miss_mm[i]);
    }
    return finite && control->start_above_mm >= 0.0 && isfinite(control->start_above_mm) &&
           control->touch_feed_mm_min > 0.0 && isfinite(control->touch_feed_mm_min) &&
           control->search_mm >= 0.0 && isfinite(control->search_mm) &&
           (control->path == SIM_PATH_SKIP || control->path == SIM_PATH_PLC);
}

int sim_451_open(const sim_rig_t *rig, const sim_machine_t *truth, const sim_machine_t *believed,
                 const sim_control_t *control, sim_451_t **opened)
{
    sim_rig_t setup = *rig;
    int wrong = is_control(control) ? five_axis_check(truth, believed, rig) : SIM_PLAY_ERR_CONTROL;
    *opened = NULL;
    if (wrong != SIM_PLAY_OK) {
        return wrong;
    }
    sim_451_t *play = calloc(1u, sizeof *play);
    if (play == NULL) {
        return SIM_PLAY_ERR_MEMORY;
    }
    play->truth = *truth;
    play->chain = *rig->chain;
    setup.chain = &play->chain;
    play->control = *control;
    five_axis_believe(&play->belief, believed);
    kinematics_settings_reset(&play->settings, KINEMATICS_MEASURE);
    five_axis_boot(
        &play->rig, &play->truth, &setup,
        (five_axis_touching_t){control->touch_feed_mm_min, control->path, control->track != 0});
    prepare(play);
    *opened = play;
    return SIM_PLAY_OK;
}

void sim_451_close(sim_451_t *play)
{
    free(play);
}

int sim_451_set(sim_451_t *play, uint16_t id, double value, int32_t word)
{
    if (word != KINEMATICS_NUMBER) {
        return (int)kinematics_settings_set_word(&play->settings, id, (kinematics_word_t)word);
    }
    return (int)kinematics_settings_set(&play->settings, id, value);
}

const char *sim_451_phrase(int setting_error)
{
    return kinematics_settings_phrase((kinematics_setting_error_t)setting_error);
}

const char *sim_451_fault_phrase(int error)
{
    return kinematics_cycle_phrase((kinematics_cycle_error_t)error);
}

const char *sim_451_limits(int32_t number, uint16_t id, double *low, double *high, double *initial)
{
    kinematics_kind_t                       kind = number == 452   ? KINEMATICS_COMPENSATE_PRESET
                                                   : number == 453 ? KINEMATICS_MEASURE_GRID
                                                                   : KINEMATICS_MEASURE;
    const kinematics_setting_description_t *row =
        kinematics_settings_of(kind, kinematics_settings_find(id));
    if (row == NULL) {
        return NULL;
    }
    *low = row->low;
    *high = row->high;
    *initial = row->initial;
    return row->name;
}

int sim_451_run(sim_451_t *play)
{
    if (!play->is_started) {
        kinematics_cycle_machine_t machine = description(play);
        play->is_started = true;
        play->input.outcome = KINEMATICS_CYCLE_CARRIED_OUT;
        if (kinematics_cycle_start(&play->cycle, &play->settings, &machine) !=
            KINEMATICS_CYCLE_OK) {
            return SIM_451_FAILED;
        }
    }
    return run_on(play);
}

int sim_451_run_measured(sim_451_t *play, const sim_station_t *stations, uint32_t n)
{
    kinematics_cycle_machine_t machine = description(play);
    kinematics_station_t       measured[KINEMATICS_STATIONS_MAX];
    uint32_t count = n <= KINEMATICS_STATIONS_MAX ? n : 0u; /* the cycle refuses none */
    for (uint32_t i = 0u; i < count; ++i) {
        measured[i] = five_axis_station(&stations[i]);
    }
    play->is_started = true;
    play->input.outcome = KINEMATICS_CYCLE_CARRIED_OUT;
    if (kinematics_cycle_start_measured(&play->cycle, &play->settings, &machine, measured,
                                        (uint8_t)count) != KINEMATICS_CYCLE_OK) {
        return SIM_451_FAILED;
    }
    return run_on(play);
}

int sim_451_answer(sim_451_t *play, double change_mm, int32_t is_possible)
{
    play->input.change_mm = change_mm;
    play->input.outcome =
        is_possible != 0 ? KINEMATICS_CYCLE_CARRIED_OUT : KINEMATICS_CYCLE_IMPOSSIBLE;
    return run_on(play);
}

void sim_machine_expect(const sim_machine_t *believed, const double sphere_mm[3],
                        const double angle_deg[3], double reading_mm[3])
{
    five_axis_belief_t belief;
    five_axis_believe(&belief, believed);
    five_axis_expect(&belief, sphere_mm, angle_deg, reading_mm);
}

void sim_machine_compensation(const sim_machine_t *believed, const double angle_deg[3],
                              double offset_mm[3])
{
    five_axis_belief_t belief;
    five_axis_believe(&belief, believed);
    five_axis_compensation(&belief, angle_deg, offset_mm);
}

uint32_t sim_451_stations(const sim_451_t *play, sim_station_t *stations, uint32_t capacity)
{
    const kinematics_plan_t *plan = kinematics_cycle_plan(&play->cycle);
    for (uint32_t i = 0; i < plan->measured && i < capacity; ++i) {
        const kinematics_station_t *from = &plan->stations[i];
        stations[i] = (sim_station_t){
            .radius_mm = from->radius_mm,
            .axis = from->axis,
            .serves = from->serves,
            .approach = from->approach,
            .is_reference = from->is_reference,
            .is_second = from->is_second,
        };
        copy(stations[i].angle_deg, from->angle_deg);
        copy(stations[i].centre_mm, from->centre_mm);
    }
    return plan->measured;
}

void sim_451_report(const sim_451_t *play, sim_451_report_t *report)
{
    const kinematics_cycle_fault_t         *fault = kinematics_cycle_fault(&play->cycle);
    const kinematics_setting_description_t *row =
        kinematics_settings_describe((uint32_t)fault->parameter);
    *report = (sim_451_report_t){
        .change_mm = play->change_mm,
        .duration_s = play->duration_s,
        .touches = play->touches,
        .error = (int32_t)fault->error,
        .parameter = row == NULL ? 0 : row->id,
        .touch_error = play->rig.error,
        .cancelled_rotation = play->is_rotation_cancelled,
        .presets = play->presets,
        .is_tilted = play->is_tilted,
    };
    copy(report->tilt_deg, play->tilt_deg);
    copy(report->preset_mm, play->preset_mm);
}
