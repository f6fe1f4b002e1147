#include "cycle/kinematics_cycle.h"

#include <math.h>
#include <string.h>

#define NO_M_FUNCTION (-1)

enum { MODE_CHECK, MODE_POSITIONS, MODE_ANGLES, MODE_DATUM };                /* Q406 */
enum { PRESET_NEVER, PRESET_BEFORE, PRESET_AFTER, PRESET_BEFORE_AND_AFTER }; /* Q431 */

/* ---- what the settings come to ---- */

static uint8_t whole(const kinematics_cycle_t *cycle, kinematics_setting_t setting)
{
    return (uint8_t)cycle->settings.value[setting];
}

static double number(const kinematics_cycle_t *cycle, kinematics_setting_t setting)
{
    return cycle->settings.value[setting];
}

static double positioning_feed(const kinematics_cycle_t *cycle)
{
    switch (cycle->settings.word[KINEMATICS_Q253_FEED]) {
    case KINEMATICS_FMAX:
        return cycle->machine.rapid_mm_min;
    case KINEMATICS_FAUTO:
        return cycle->machine.tool_feed_mm_min;
    case KINEMATICS_PREDEF:
        return cycle->machine.global_feed_mm_min;
    case KINEMATICS_NUMBER:
    default:
        return number(cycle, KINEMATICS_Q253_FEED);
    }
}

/* While the probe is watched, its own limit counts as well. */
static double watched_feed(const kinematics_cycle_t *cycle)
{
    return fmin(positioning_feed(cycle), cycle->machine.probe_feed_max_mm_min);
}

static double stand_off(const kinematics_cycle_t *cycle)
{
    bool is_global = cycle->settings.word[KINEMATICS_Q320_CLEARANCE] == KINEMATICS_PREDEF;
    return cycle->machine.set_up_mm + (is_global ? cycle->machine.global_clearance_mm
                                                 : number(cycle, KINEMATICS_Q320_CLEARANCE));
}

static double contact(const kinematics_cycle_t *cycle)
{
    return number(cycle, KINEMATICS_Q407_SPHERE_RADIUS) + cycle->machine.tip_radius_mm;
}

static bool has_retract_height(const kinematics_cycle_t *cycle)
{
    return number(cycle, KINEMATICS_Q408_RETRACT_HEIGHT) > 0.0;
}

static bool has_m_function(const kinematics_cycle_t *cycle)
{
    return cycle->machine.strobe_rot_ax_pos != NO_M_FUNCTION;
}

static bool presets_before(const kinematics_cycle_t *cycle)
{
    uint8_t preset = whole(cycle, KINEMATICS_Q431_PRESET);
    return preset == PRESET_BEFORE || preset == PRESET_BEFORE_AND_AFTER;
}

static bool presets_after(const kinematics_cycle_t *cycle)
{
    return whole(cycle, KINEMATICS_Q431_PRESET) >= PRESET_AFTER;
}

/* ---- before anything moves ---- */

static bool is_length(double mm)
{
    return isfinite(mm) && mm >= 0.0;
}

static bool is_sound(const kinematics_cycle_machine_t *machine)
{
    double square = 0.0;
    bool sound = is_length(machine->tip_radius_mm) && is_length(machine->set_up_mm) &&
                 is_length(machine->global_clearance_mm) &&
                 is_length(machine->max_modification_mm) &&
                 is_length(machine->max_dev_cal_ball_mm) && machine->probe_feed_max_mm_min > 0.0 &&
                 machine->strobe_rot_ax_pos >= NO_M_FUNCTION;
    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        sound = sound && is_length(fabs(machine->position_mm[i])) &&
                is_length(fabs(machine->preset_mm[i]));
        square += machine->tool_axis[i] * machine->tool_axis[i];
    }
    for (uint8_t i = 0u; i < ROTARY_AXES; i++) {
        const kinematics_plan_axis_t *axis = &machine->axes[i];
        sound = sound && is_length(axis->grid_deg) && axis->grid_deg < 360.0 &&
                is_length(fabs(machine->angle_deg[i]));
    }
    return sound && fabs(square - 1.0) < 1e-6;
}

static bool is_at_zero(const kinematics_cycle_t *cycle)
{
    const double zero[ROTARY_AXES] = {0.0, 0.0, 0.0};
    return kinematics_plan_is_pose(cycle->angle_deg, zero);
}

/* A Hirth coupling is lifted to turn, and no linear axis can go along with that. */
static bool turns_a_coupling(const kinematics_cycle_t *cycle)
{
    for (uint8_t i = 0u; i < cycle->plan.count; i++) {
        for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
            if (cycle->machine.axes[axis].grid_deg > 0.0 &&
                !kinematics_plan_is_there(cycle->machine.angle_deg[axis],
                                          cycle->plan.stations[i].angle_deg[axis])) {
                return true;
            }
        }
    }
    return false;
}

static kinematics_cycle_fault_t fault_of(kinematics_cycle_error_t error,
                                         kinematics_setting_t     parameter)
{
    return (kinematics_cycle_fault_t){error, parameter};
}

static kinematics_cycle_fault_t check_settings(const kinematics_cycle_t *cycle)
{
    kinematics_setting_t setting = kinematics_settings_fault(&cycle->settings);
    if (setting != KINEMATICS_SETTINGS) {
        return fault_of(KINEMATICS_CYCLE_ERR_SETTING, setting);
    }
    if (!(positioning_feed(cycle) > 0.0)) {
        return fault_of(KINEMATICS_CYCLE_ERR_NO_FEED, KINEMATICS_Q253_FEED);
    }
    if (!(stand_off(cycle) > 0.0)) {
        return fault_of(KINEMATICS_CYCLE_ERR_NO_CLEARANCE, KINEMATICS_Q320_CLEARANCE);
    }
    uint8_t mode = whole(cycle, KINEMATICS_Q406_MODE);
    if (mode >= MODE_ANGLES && !cycle->machine.has_kinematics_comp) {
        return fault_of(KINEMATICS_CYCLE_ERR_OPTION, KINEMATICS_Q406_MODE);
    }
    if (mode == MODE_DATUM && !cycle->machine.is_stacked) {
        return fault_of(KINEMATICS_CYCLE_ERR_NOT_STACKED, KINEMATICS_Q406_MODE);
    }
    return fault_of(KINEMATICS_CYCLE_OK, KINEMATICS_SETTINGS);
}

/* The settings are sound, and the plan is made of them. */
static kinematics_cycle_fault_t check_plan(const kinematics_cycle_t *cycle)
{
    bool may_follow = cycle->machine.has_advanced_functions_2 && !turns_a_coupling(cycle);
    if (!has_retract_height(cycle) && !may_follow) {
        return fault_of(KINEMATICS_CYCLE_ERR_RETRACT, KINEMATICS_Q408_RETRACT_HEIGHT);
    }
    if (cycle->machine.is_tcpm_on) {
        return fault_of(KINEMATICS_CYCLE_ERR_TCPM, KINEMATICS_SETTINGS);
    }
    if (cycle->machine.is_turning) {
        return fault_of(KINEMATICS_CYCLE_ERR_TURNING, KINEMATICS_SETTINGS);
    }
    if (has_m_function(cycle) && !is_at_zero(cycle)) {
        return fault_of(KINEMATICS_CYCLE_ERR_NOT_AT_ZERO, KINEMATICS_SETTINGS);
    }
    return fault_of(cycle->plan.count > 0u ? KINEMATICS_CYCLE_OK : KINEMATICS_CYCLE_ERR_NOTHING,
                    KINEMATICS_SETTINGS);
}

static kinematics_cycle_fault_t prepare(kinematics_cycle_t *cycle)
{
    kinematics_cycle_fault_t fault = check_settings(cycle);
    if (fault.error != KINEMATICS_CYCLE_OK) {
        return fault;
    }
    if (!is_sound(&cycle->machine)) {
        return fault_of(KINEMATICS_CYCLE_ERR_MACHINE, KINEMATICS_SETTINGS);
    }
    kinematics_plan_make(&cycle->plan, &cycle->settings, cycle->machine.axes,
                         !has_m_function(cycle));
    return check_plan(cycle);
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
    cycle->fault = fault_of(error, parameter);
    cycle->state = KINEMATICS_CYCLE_FAILED;
}

/* ---- one measurement of the sphere ---- */

static void ask_probe_step(kinematics_cycle_t *cycle, const sphere_probe_step_t *motion)
{
    kinematics_cycle_request_t *request =
        ask(cycle, cycle->step, motion->is_touch ? KINEMATICS_CYCLE_TOUCH : KINEMATICS_CYCLE_MOVE);
    copy(request->target_mm, motion->target_mm);
    copy(request->direction, motion->direction);
    request->stand_off_mm = stand_off(cycle);
    request->feed_mm_min = watched_feed(cycle);
}

static void begin_probing(kinematics_cycle_t *cycle, kinematics_cycle_step_t step)
{
    sphere_probe_config_t config = {
        .contact_mm = contact(cycle),
        .stand_off_mm = stand_off(cycle),
        .reference_deg = number(cycle, KINEMATICS_Q380_REFERENCE_ANGLE),
        .touches = whole(cycle, KINEMATICS_Q423_TOUCHES),
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
    double limit = cycle->machine.max_dev_cal_ball_mm;

    if (!sphere_probe_solve(&cycle->probe, cycle->sphere_mm, &cycle->contact_mm)) {
        fail(cycle, KINEMATICS_CYCLE_ERR_NO_SPHERE, KINEMATICS_SETTINGS);
        return false;
    }
    bool is_watched = cycle->step != KINEMATICS_STEP_SEARCH && limit > 0.0;
    if (is_watched && !(fabs(cycle->contact_mm - contact(cycle)) <= limit)) {
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

    if (has_retract_height(cycle)) {
        request = ask(cycle, step, KINEMATICS_CYCLE_RETRACT);
        request->retract_height_mm = number(cycle, KINEMATICS_Q408_RETRACT_HEIGHT);
        request->feed_mm_min = positioning_feed(cycle);
        return;
    }
    request = ask(cycle, step, KINEMATICS_CYCLE_MOVE);
    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        double above = (contact(cycle) + stand_off(cycle)) * cycle->tool_axis[i];
        request->target_mm[i] = cycle->expected_mm[i] + above;
    }
    request->feed_mm_min = watched_feed(cycle);
}

static void turn(kinematics_cycle_t *cycle, uint8_t axis, double angle_deg)
{
    cycle->angle_deg[axis] = angle_deg;

    kinematics_cycle_request_t *request =
        ask(cycle, KINEMATICS_STEP_TURN,
            has_m_function(cycle) ? KINEMATICS_CYCLE_TURN_BY_M_FUNCTION : KINEMATICS_CYCLE_TURN);
    request->axis = (rotary_axis_t)axis;
    copy(request->from_angle_deg, cycle->sphere_deg);
    copy(request->sphere_mm, cycle->sphere_mm);
    request->stand_off_mm = contact(cycle) + stand_off(cycle);
    request->feed_mm_min = positioning_feed(cycle);
    request->m_function = cycle->machine.strobe_rot_ax_pos;
    request->follow = !has_retract_height(cycle);
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
    here->radius_mm = cycle->contact_mm - cycle->machine.tip_radius_mm;
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
    if (whole(cycle, KINEMATICS_Q406_MODE) == MODE_CHECK) {
        finish(cycle);
    } else if (change_mm <= cycle->machine.max_modification_mm) {
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
    const kinematics_cycle_machine_t *machine = &cycle->machine;
    double above = presets_before(cycle) ? contact(cycle) + stand_off(cycle) : 0.0;

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
    kinematics_cycle_machine_t *machine = &cycle->machine;
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
    cycle->settings = *settings;
    cycle->machine = *machine;
    place(cycle);
    cycle->fault = prepare(cycle);
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

const char *kinematics_cycle_phrase(kinematics_cycle_error_t error)
{
    static const char *const PHRASES[] = {
        [KINEMATICS_CYCLE_OK] = "no error",
        [KINEMATICS_CYCLE_ERR_SETTING] = "a parameter is out of its limits",
        [KINEMATICS_CYCLE_ERR_NO_FEED] = "the feed for pre-positioning is 0",
        [KINEMATICS_CYCLE_ERR_NO_CLEARANCE] = "set-up clearance and SET_UP are both 0",
        [KINEMATICS_CYCLE_ERR_OPTION] = "modes 2 and 3 need KinematicsComp (option 52)",
        [KINEMATICS_CYCLE_ERR_NOT_STACKED] = "mode 3 needs one rotary axis upon another",
        [KINEMATICS_CYCLE_ERR_RETRACT] = "a retract height above 0 is needed: an axis with a Hirth "
                                         "coupling turns, or option 2 is not there",
        [KINEMATICS_CYCLE_ERR_TCPM] = "M128 or TCPM is on",
        [KINEMATICS_CYCLE_ERR_TURNING] = "FUNCTION MODE MILL is not active",
        [KINEMATICS_CYCLE_ERR_NOT_AT_ZERO] = "an M function positions the rotary axes, and not all "
                                             "of them are at 0°",
        [KINEMATICS_CYCLE_ERR_MACHINE] = "the machine's data are not sound",
        [KINEMATICS_CYCLE_ERR_NOTHING] = "no rotary axis that is there has a position to measure",
        [KINEMATICS_CYCLE_ERR_REQUEST] = "a motion, a touch or another request failed",
        [KINEMATICS_CYCLE_ERR_NO_SPHERE] = "the touched points do not lie on a sphere",
        [KINEMATICS_CYCLE_ERR_BALL_RADIUS] = "the measured radius of the sphere is off by more "
                                             "than maxDevCalBall (204802)",
        [KINEMATICS_CYCLE_ERR_REFUSED] = "a change above maxModification (204801) was not "
                                         "acknowledged; the kinematics are unchanged",
    };
    return PHRASES[error];
}

const kinematics_cycle_fault_t *kinematics_cycle_fault(const kinematics_cycle_t *cycle)
{
    return &cycle->fault;
}

const kinematics_plan_t *kinematics_cycle_plan(const kinematics_cycle_t *cycle)
{
    return &cycle->plan;
}
