#include "cycle/kinematics_cycle.h"

#include "cycle/kinematics_requests.h"

static void copy(double *to, const double *from)
{
    for (uint8_t i = 0u; i < 3u; i++) {
        to[i] = from[i];
    }
}

static void fail(kinematics_cycle_t *cycle, kinematics_cycle_error_t error,
                 kinematics_setting_t parameter)
{
    cycle->fault = (kinematics_cycle_fault_t){error, parameter};
    cycle->state = KINEMATICS_CYCLE_FAILED;
}

/* ---- one measurement of the sphere ---- */

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
    kinematics_request_probe_step(cycle, &motion);
}

static bool take_sphere(kinematics_cycle_t *cycle)
{
    if (!sphere_probe_solve(&cycle->probe, cycle->sphere_mm, &cycle->contact_mm)) {
        fail(cycle, KINEMATICS_CYCLE_ERR_NO_SPHERE, KINEMATICS_SETTINGS);
        return false;
    }
    bool is_watched = cycle->step != KINEMATICS_STEP_SEARCH;
    if (is_watched && !kinematics_conditions_is_the_sphere(&cycle->job, cycle->contact_mm)) {
        fail(cycle, KINEMATICS_CYCLE_ERR_BALL_RADIUS, KINEMATICS_Q407_SPHERE_RADIUS);
        return false;
    }
    copy(cycle->sphere_deg, cycle->stance.angle_deg);
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
        kinematics_request_probe_step(cycle, &motion);
        return false;
    }
    return take_sphere(cycle);
}

/* ---- from station to station ---- */

static void take_station(kinematics_cycle_t *cycle)
{
    kinematics_station_t *here = &cycle->plan.stations[cycle->plan.measured];

    copy(here->centre_mm, cycle->sphere_mm);
    here->radius_mm = cycle->contact_mm - cycle->job.machine.tip_radius_mm;
    cycle->plan.measured++;
}

/* Where a preset has just been set the sphere is known, and not measured again. */
static void go_to_station(kinematics_cycle_t *cycle)
{
    if (cycle->is_located && kinematics_stance_is_at(&cycle->stance, &cycle->plan)) {
        take_station(cycle);
    }
    cycle->is_located = false;
    if (cycle->plan.measured < cycle->plan.count) {
        kinematics_request_leave(cycle, KINEMATICS_STEP_LEAVE);
    } else {
        kinematics_request_leave(cycle, KINEMATICS_STEP_WITHDRAW);
    }
}

static void turn_or_measure(kinematics_cycle_t *cycle)
{
    uint8_t axis;
    if (kinematics_stance_turn(&cycle->stance, &cycle->plan, &axis)) {
        kinematics_request_turn(cycle, axis);
    } else {
        begin_probing(cycle, KINEMATICS_STEP_MEASURE);
    }
}

/* ---- before the first station and after the last ---- */

static void begin_measuring(kinematics_cycle_t *cycle)
{
    if (kinematics_conditions_presets_before(&cycle->job)) {
        begin_probing(cycle, KINEMATICS_STEP_SEARCH);
    } else {
        go_to_station(cycle);
    }
}

static void tilt(kinematics_cycle_t *cycle)
{
    (void)kinematics_request_begin(cycle, KINEMATICS_STEP_TILT, KINEMATICS_CYCLE_TILT);
}

/* The sphere stands still on its table: the first reference tells where it is. */
static void finish(kinematics_cycle_t *cycle)
{
    const kinematics_station_t *first = &cycle->plan.stations[0];

    if (kinematics_conditions_presets_after(&cycle->job)) {
        kinematics_request_preset(cycle, KINEMATICS_STEP_PRESET_AFTER, first->angle_deg,
                                  first->centre_mm);
    } else {
        tilt(cycle);
    }
}

static void take_evaluation(kinematics_cycle_t *cycle, double change_mm)
{
    cycle->change_mm = change_mm;
    if (kinematics_conditions_mode(&cycle->job) == KINEMATICS_MODE_CHECK) {
        finish(cycle);
    } else if (change_mm <= cycle->job.machine.max_modification_mm) {
        (void)kinematics_request_begin(cycle, KINEMATICS_STEP_APPLY, KINEMATICS_CYCLE_APPLY);
    } else {
        kinematics_request_begin(cycle, KINEMATICS_STEP_ACKNOWLEDGE, KINEMATICS_CYCLE_ACKNOWLEDGE)
            ->change_mm = change_mm;
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
        kinematics_request_preset(cycle, KINEMATICS_STEP_PRESET_BEFORE, cycle->stance.angle_deg,
                                  cycle->sphere_mm);
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
        (void)kinematics_request_begin(cycle, KINEMATICS_STEP_EVALUATE, KINEMATICS_CYCLE_EVALUATE);
        break;
    case KINEMATICS_STEP_EVALUATE:
        take_evaluation(cycle, input->change_mm);
        break;
    case KINEMATICS_STEP_ACKNOWLEDGE:
        (void)kinematics_request_begin(cycle, KINEMATICS_STEP_APPLY, KINEMATICS_CYCLE_APPLY);
        break;
    case KINEMATICS_STEP_APPLY:
        finish(cycle);
        break;
    case KINEMATICS_STEP_PRESET_AFTER:
        tilt(cycle);
        break;
    case KINEMATICS_STEP_CLEAR:
    case KINEMATICS_STEP_TILT:
    default:
        cycle->state = KINEMATICS_CYCLE_DONE;
        break;
    }
}

/* ---- what the caller calls ---- */

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
