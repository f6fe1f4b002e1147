#include "cycle/kinematics_cycle.h"

#include <math.h>
#include <string.h>

/* ---- what the settings come to ---- */

static bool presets_before(const kinematics_cycle_t *cycle)
{
    uint8_t preset = kinematics_conditions_whole(&cycle->job, KINEMATICS_Q431_PRESET);
    return preset == KINEMATICS_PRESET_BEFORE || preset == KINEMATICS_PRESET_BEFORE_AND_AFTER;
}

static bool presets_after(const kinematics_cycle_t *cycle)
{
    return kinematics_conditions_whole(&cycle->job, KINEMATICS_Q431_PRESET) >=
           KINEMATICS_PRESET_AFTER;
}

/* ---- requests ---- */

static void copy(double *to, const double *from)
{
    for (uint8_t i = 0u; i < 3u; i++) {
        to[i] = from[i];
    }
}

static kinematics_cycle_request_t *ask(kinematics_cycle_t *cycle, kinematics_cycle_step_t step,
                                       kinematics_cycle_request_kind_t kind)
{
    cycle->request = (kinematics_cycle_request_t){.kind = kind};
    copy(cycle->request.angle_deg, cycle->angle_deg);
    cycle->step = step;
    cycle->has_request = true;
    return &cycle->request;
}

static void fail(kinematics_cycle_t *cycle, kinematics_cycle_error_t error,
                 kinematics_setting_t parameter)
{
    cycle->fault = (kinematics_cycle_fault_t){error, parameter};
    cycle->state = KINEMATICS_CYCLE_FAILED;
}

/* ---- one measurement of the sphere ---- */

static void ask_probe_step(kinematics_cycle_t *cycle, const sphere_probe_step_t *motion)
{
    kinematics_cycle_request_t *request =
        ask(cycle, cycle->step, motion->is_touch ? KINEMATICS_CYCLE_TOUCH : KINEMATICS_CYCLE_MOVE);
    copy(request->target_mm, motion->target_mm);
    copy(request->direction, motion->direction);
    request->stand_off_mm = kinematics_conditions_stand_off(&cycle->job);
    request->feed_mm_min = kinematics_conditions_watched_feed(&cycle->job);
}

static void begin_probing(kinematics_cycle_t *cycle, kinematics_cycle_step_t step)
{
    sphere_probe_config_t config = {
        .contact_mm = kinematics_conditions_contact(&cycle->job),
        .stand_off_mm = kinematics_conditions_stand_off(&cycle->job),
        .reference_deg = cycle->job.settings.value[KINEMATICS_Q380_REFERENCE_ANGLE],
        .touches = kinematics_conditions_whole(&cycle->job, KINEMATICS_Q423_TOUCHES),
    };
    sphere_probe_step_t motion;

    copy(config.centre_mm, cycle->expected_mm);
    copy(config.tool_axis, cycle->tool_axis);
    sphere_probe_start(&cycle->probe, &config);
    cycle->step = step;
    (void)sphere_probe_next(&cycle->probe, &motion); /* there is always a first one */
    ask_probe_step(cycle, &motion);
}

/* One sphere, unless the cycle only searches for it, is the one of Q407. */
static bool take_sphere(kinematics_cycle_t *cycle)
{
    double limit = cycle->job.machine.max_dev_cal_ball_mm;

    if (!sphere_probe_solve(&cycle->probe, cycle->sphere_mm, &cycle->contact_mm)) {
        fail(cycle, KINEMATICS_CYCLE_ERR_NO_SPHERE, KINEMATICS_SETTINGS);
        return false;
    }
    bool is_watched = cycle->step != KINEMATICS_STEP_SEARCH && limit > 0.0;
    if (is_watched &&
        !(fabs(cycle->contact_mm - kinematics_conditions_contact(&cycle->job)) <= limit)) {
        fail(cycle, KINEMATICS_CYCLE_ERR_BALL_RADIUS, KINEMATICS_Q407_SPHERE_RADIUS);
        return false;
    }
    copy(cycle->sphere_deg, cycle->angle_deg);
    copy(cycle->expected_mm, cycle->sphere_mm);
    return true;
}

/* True when all touches are made and the sphere is found. */
static bool poll_probing(kinematics_cycle_t *cycle, const kinematics_cycle_input_t *input)
{
    sphere_probe_step_t motion;

    if (cycle->request.kind == KINEMATICS_CYCLE_TOUCH) {
        sphere_probe_touched(&cycle->probe, input->touched_mm);
    }
    if (sphere_probe_next(&cycle->probe, &motion)) {
        ask_probe_step(cycle, &motion);
        return false;
    }
    return take_sphere(cycle);
}

/* ---- from station to station ---- */

static kinematics_station_t *station(kinematics_cycle_t *cycle)
{
    return &cycle->plan.stations[cycle->plan.measured];
}

static void leave(kinematics_cycle_t *cycle, kinematics_cycle_step_t step)
{
    kinematics_cycle_request_t *request;

    if (kinematics_conditions_has_retract_height(&cycle->job)) {
        request = ask(cycle, step, KINEMATICS_CYCLE_RETRACT);
        request->retract_height_mm = cycle->job.settings.value[KINEMATICS_Q408_RETRACT_HEIGHT];
        request->feed_mm_min = kinematics_conditions_feed(&cycle->job);
        return;
    }
    request = ask(cycle, step, KINEMATICS_CYCLE_MOVE);
    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        double above = (kinematics_conditions_contact(&cycle->job) +
                        kinematics_conditions_stand_off(&cycle->job)) *
                       cycle->tool_axis[i];
        request->target_mm[i] = cycle->expected_mm[i] + above;
    }
    request->feed_mm_min = kinematics_conditions_watched_feed(&cycle->job);
}

static void turn(kinematics_cycle_t *cycle, uint8_t axis, double angle_deg)
{
    cycle->angle_deg[axis] = angle_deg;

    kinematics_cycle_request_t *request =
        ask(cycle, KINEMATICS_STEP_TURN,
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

/* A first, then B, then C; the measured axis by way of its come_from_deg. False: all are there. */
static bool turn_next(kinematics_cycle_t *cycle)
{
    const kinematics_station_t *next = station(cycle);

    for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
        bool comes_by = axis == next->axis && next->approach != 0 && !cycle->has_come_by;
        if (comes_by) {
            cycle->has_come_by = true;
            turn(cycle, axis, next->come_from_deg);
            return true;
        }
        if (!kinematics_plan_is_there(cycle->angle_deg[axis], next->angle_deg[axis])) {
            turn(cycle, axis, next->angle_deg[axis]);
            return true;
        }
    }
    return false;
}

static void take_station(kinematics_cycle_t *cycle)
{
    kinematics_station_t *here = station(cycle);

    copy(here->centre_mm, cycle->sphere_mm);
    here->radius_mm = cycle->contact_mm - cycle->job.machine.tip_radius_mm;
    cycle->plan.measured++;
    cycle->has_come_by = false;
}

/* Where a preset has just been set the sphere is known, and not measured again. */
static void go_to_station(kinematics_cycle_t *cycle)
{
    const kinematics_station_t *next = station(cycle);

    if (cycle->is_located && next->approach == 0 &&
        kinematics_plan_is_pose(cycle->angle_deg, next->angle_deg)) {
        take_station(cycle);
    }
    cycle->is_located = false;
    if (cycle->plan.measured < cycle->plan.count) {
        leave(cycle, KINEMATICS_STEP_LEAVE);
    } else {
        leave(cycle, KINEMATICS_STEP_WITHDRAW);
    }
}

static void turn_or_measure(kinematics_cycle_t *cycle)
{
    if (!turn_next(cycle)) {
        begin_probing(cycle, KINEMATICS_STEP_MEASURE);
    }
}

/* ---- before the first station and after the last ---- */

static void begin_measuring(kinematics_cycle_t *cycle)
{
    if (presets_before(cycle)) {
        begin_probing(cycle, KINEMATICS_STEP_SEARCH);
    } else {
        go_to_station(cycle);
    }
}

static void set_preset(kinematics_cycle_t *cycle, kinematics_cycle_step_t step,
                       const double *angle_deg, const double *centre_mm)
{
    kinematics_cycle_request_t *request = ask(cycle, step, KINEMATICS_CYCLE_SET_PRESET);
    copy(request->angle_deg, angle_deg);
    copy(request->sphere_mm, centre_mm);
}

/* The sphere stands still on its table: the first reference tells where it is. */
static void finish(kinematics_cycle_t *cycle)
{
    const kinematics_station_t *first = &cycle->plan.stations[0];

    if (presets_after(cycle)) {
        set_preset(cycle, KINEMATICS_STEP_PRESET_AFTER, first->angle_deg, first->centre_mm);
    } else {
        cycle->state = KINEMATICS_CYCLE_DONE;
    }
}

static void take_evaluation(kinematics_cycle_t *cycle, double change_mm)
{
    cycle->change_mm = change_mm;
    if (kinematics_conditions_whole(&cycle->job, KINEMATICS_Q406_MODE) == KINEMATICS_MODE_CHECK) {
        finish(cycle);
    } else if (change_mm <= cycle->job.machine.max_modification_mm) {
        (void)ask(cycle, KINEMATICS_STEP_APPLY, KINEMATICS_CYCLE_APPLY);
    } else {
        ask(cycle, KINEMATICS_STEP_ACKNOWLEDGE, KINEMATICS_CYCLE_ACKNOWLEDGE)->change_mm =
            change_mm;
    }
}

/* ---- what to do once a request is carried out ---- */

static void poll_sphere(kinematics_cycle_t *cycle, const kinematics_cycle_input_t *input)
{
    kinematics_cycle_step_t step = cycle->step;

    if (!poll_probing(cycle, input)) {
        return;
    }
    if (step == KINEMATICS_STEP_SEARCH) {
        begin_probing(cycle, KINEMATICS_STEP_LOCATE);
    } else if (step == KINEMATICS_STEP_LOCATE) {
        cycle->is_located = true;
        set_preset(cycle, KINEMATICS_STEP_PRESET_BEFORE, cycle->angle_deg, cycle->sphere_mm);
    } else {
        take_station(cycle);
        go_to_station(cycle);
    }
}

static void advance(kinematics_cycle_t *cycle, const kinematics_cycle_input_t *input)
{
    switch (cycle->step) {
    case KINEMATICS_STEP_CANCEL_ROTATION:
        begin_measuring(cycle);
        break;
    case KINEMATICS_STEP_SEARCH:
    case KINEMATICS_STEP_LOCATE:
    case KINEMATICS_STEP_MEASURE:
        poll_sphere(cycle, input);
        break;
    case KINEMATICS_STEP_PRESET_BEFORE:
        go_to_station(cycle);
        break;
    case KINEMATICS_STEP_TURN:
        copy(cycle->expected_mm, input->centre_mm);
        copy(cycle->tool_axis, input->tool_axis);
        turn_or_measure(cycle);
        break;
    case KINEMATICS_STEP_LEAVE:
        turn_or_measure(cycle);
        break;
    case KINEMATICS_STEP_WITHDRAW:
        (void)ask(cycle, KINEMATICS_STEP_EVALUATE, KINEMATICS_CYCLE_EVALUATE);
        break;
    case KINEMATICS_STEP_EVALUATE:
        take_evaluation(cycle, input->change_mm);
        break;
    case KINEMATICS_STEP_ACKNOWLEDGE:
        (void)ask(cycle, KINEMATICS_STEP_APPLY, KINEMATICS_CYCLE_APPLY);
        break;
    case KINEMATICS_STEP_APPLY:
        finish(cycle);
        break;
    case KINEMATICS_STEP_PRESET_AFTER:
    default:
        cycle->state = KINEMATICS_CYCLE_DONE;
        break;
    }
}

/* ---- what the caller calls ---- */

/* The preset is the sphere's centre, or the probe has been put above it by hand. */
static void expect_sphere(kinematics_cycle_t *cycle)
{
    const kinematics_cycle_machine_t *machine = &cycle->job.machine;
    double above = presets_before(cycle) ? kinematics_conditions_contact(&cycle->job) +
                                               kinematics_conditions_stand_off(&cycle->job)
                                         : 0.0;

    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        cycle->expected_mm[i] = presets_before(cycle)
                                    ? machine->position_mm[i] - above * machine->tool_axis[i]
                                    : machine->preset_mm[i];
    }
    copy(cycle->sphere_mm, cycle->expected_mm);
    copy(cycle->sphere_deg, cycle->angle_deg);
}

/* An axis that is not there stands at 0°, whatever else is said of it. */
static void place(kinematics_cycle_t *cycle)
{
    kinematics_cycle_machine_t *machine = &cycle->job.machine;
    for (uint8_t i = 0u; i < ROTARY_AXES; i++) {
        if (!machine->axes[i].is_present) {
            machine->axes[i].grid_deg = 0.0;
            machine->angle_deg[i] = 0.0;
        }
    }
    copy(cycle->angle_deg, machine->angle_deg);
    copy(cycle->tool_axis, machine->tool_axis);
}

kinematics_cycle_error_t kinematics_cycle_start(kinematics_cycle_t               *cycle,
                                                const kinematics_settings_t      *settings,
                                                const kinematics_cycle_machine_t *machine)
{
    memset(cycle, 0, sizeof *cycle); /* too large to be copied by way of the stack */
    cycle->job.settings = *settings;
    cycle->job.machine = *machine;
    place(cycle);
    cycle->fault = kinematics_conditions_check(&cycle->job, &cycle->plan);
    if (cycle->fault.error != KINEMATICS_CYCLE_OK) {
        cycle->state = KINEMATICS_CYCLE_FAILED;
        return cycle->fault.error;
    }
    expect_sphere(cycle);
    cycle->state = KINEMATICS_CYCLE_RUNNING;
    (void)ask(cycle, KINEMATICS_STEP_CANCEL_ROTATION, KINEMATICS_CYCLE_CANCEL_ROTATION);
    return KINEMATICS_CYCLE_OK;
}

kinematics_cycle_state_t kinematics_cycle_poll(kinematics_cycle_t             *cycle,
                                               const kinematics_cycle_input_t *input)
{
    bool is_waiting = cycle->has_request || input->outcome == KINEMATICS_CYCLE_BUSY;

    if (cycle->state != KINEMATICS_CYCLE_RUNNING || is_waiting) {
        return cycle->state;
    }
    if (input->outcome == KINEMATICS_CYCLE_CARRIED_OUT) {
        advance(cycle, input);
    } else if (cycle->step == KINEMATICS_STEP_ACKNOWLEDGE) {
        fail(cycle, KINEMATICS_CYCLE_ERR_REFUSED, KINEMATICS_SETTINGS);
    } else {
        fail(cycle, KINEMATICS_CYCLE_ERR_REQUEST, KINEMATICS_SETTINGS);
    }
    return cycle->state;
}

bool kinematics_cycle_take_request(kinematics_cycle_t *cycle, kinematics_cycle_request_t *request)
{
    bool taken = cycle->has_request;
    if (taken) {
        *request = cycle->request;
        cycle->has_request = false;
    }
    return taken;
}

const kinematics_cycle_fault_t *kinematics_cycle_fault(const kinematics_cycle_t *cycle)
{
    return &cycle->fault;
}

const kinematics_plan_t *kinematics_cycle_plan(const kinematics_cycle_t *cycle)
{
    return &cycle->plan;
}
