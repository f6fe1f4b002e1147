#include "cycle/kinematics_conditions.h"

#include <math.h>

#define NO_M_FUNCTION (-1)

/* ---- what the settings come to ---- */

uint8_t kinematics_conditions_whole(const kinematics_job_t *job, kinematics_setting_t setting)
{
    return (uint8_t)job->settings.value[setting];
}

int8_t kinematics_conditions_mode(const kinematics_job_t *job)
{
    return (int8_t)job->settings.value[KINEMATICS_Q406_MODE];
}

static double number(const kinematics_job_t *job, kinematics_setting_t setting)
{
    return job->settings.value[setting];
}

double kinematics_conditions_feed(const kinematics_job_t *job)
{
    switch (job->settings.word[KINEMATICS_Q253_FEED]) {
    case KINEMATICS_FMAX:
        return job->machine.rapid_mm_min;
    case KINEMATICS_FAUTO:
        return job->machine.tool_feed_mm_min;
    case KINEMATICS_PREDEF:
        return job->machine.global_feed_mm_min;
    case KINEMATICS_NUMBER:
    default:
        return number(job, KINEMATICS_Q253_FEED) > 0.0 ? number(job, KINEMATICS_Q253_FEED)
                                                       : job->machine.probe_feed_max_mm_min;
    }
}

/* While the probe is watched, its own limit counts as well. */
double kinematics_conditions_watched_feed(const kinematics_job_t *job)
{
    return fmin(kinematics_conditions_feed(job), job->machine.probe_feed_max_mm_min);
}

double kinematics_conditions_stand_off(const kinematics_job_t *job)
{
    bool is_global = job->settings.word[KINEMATICS_Q320_CLEARANCE] == KINEMATICS_PREDEF;
    return job->machine.set_up_mm +
           (is_global ? job->machine.global_clearance_mm : number(job, KINEMATICS_Q320_CLEARANCE));
}

double kinematics_conditions_contact(const kinematics_job_t *job)
{
    return number(job, KINEMATICS_Q407_SPHERE_RADIUS) + job->machine.tip_radius_mm;
}

bool kinematics_conditions_has_retract_height(const kinematics_job_t *job)
{
    return number(job, KINEMATICS_Q408_RETRACT_HEIGHT) > 0.0;
}

bool kinematics_conditions_has_m_function(const kinematics_job_t *job)
{
    return job->machine.strobe_rot_ax_pos != NO_M_FUNCTION;
}

bool kinematics_conditions_presets_before(const kinematics_job_t *job)
{
    uint8_t preset = kinematics_conditions_whole(job, KINEMATICS_Q431_PRESET);
    return preset == KINEMATICS_PRESET_BEFORE || preset == KINEMATICS_PRESET_BEFORE_AND_AFTER;
}

bool kinematics_conditions_presets_after(const kinematics_job_t *job)
{
    return kinematics_conditions_whole(job, KINEMATICS_Q431_PRESET) >= KINEMATICS_PRESET_AFTER;
}

bool kinematics_conditions_is_the_sphere(const kinematics_job_t *job, double contact_mm)
{
    double limit = job->machine.max_dev_cal_ball_mm;
    return !(limit > 0.0) || fabs(contact_mm - kinematics_conditions_contact(job)) <= limit;
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

static bool is_at_zero(const kinematics_job_t *job)
{
    const double zero[ROTARY_AXES] = {0.0, 0.0, 0.0};
    return kinematics_plan_is_pose(job->machine.angle_deg, zero);
}

/* A Hirth coupling is lifted to turn, and no linear axis can go along with that. */
static bool turns_a_coupling(const kinematics_job_t *job, const kinematics_plan_t *plan)
{
    for (uint8_t i = 0u; i < plan->count; i++) {
        for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
            if (job->machine.axes[axis].grid_deg > 0.0 &&
                !kinematics_plan_is_there(job->machine.angle_deg[axis],
                                          plan->stations[i].angle_deg[axis])) {
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

static kinematics_cycle_fault_t check_settings(const kinematics_job_t *job)
{
    kinematics_setting_t setting = kinematics_settings_fault(&job->settings);
    if (!job->machine.has_kinematics_opt) {
        return fault_of(KINEMATICS_CYCLE_ERR_NO_CYCLE, KINEMATICS_SETTINGS);
    }
    if (setting != KINEMATICS_SETTINGS) {
        return fault_of(KINEMATICS_CYCLE_ERR_SETTING, setting);
    }
    if (!(kinematics_conditions_feed(job) > 0.0)) {
        return fault_of(KINEMATICS_CYCLE_ERR_NO_FEED, KINEMATICS_Q253_FEED);
    }
    if (!(kinematics_conditions_stand_off(job) > 0.0)) {
        return fault_of(KINEMATICS_CYCLE_ERR_NO_CLEARANCE, KINEMATICS_Q320_CLEARANCE);
    }
    if (job->settings.kind == KINEMATICS_MEASURE_GRID && !job->machine.has_kinematics_comp) {
        return fault_of(KINEMATICS_CYCLE_ERR_NO_COMP, KINEMATICS_SETTINGS);
    }
    int8_t mode = kinematics_conditions_mode(job);
    if (mode >= KINEMATICS_MODE_ANGLES && !job->machine.has_kinematics_comp) {
        return fault_of(KINEMATICS_CYCLE_ERR_OPTION, KINEMATICS_Q406_MODE);
    }
    if (mode == KINEMATICS_MODE_DATUM && !job->machine.is_stacked) {
        return fault_of(KINEMATICS_CYCLE_ERR_NOT_STACKED, KINEMATICS_Q406_MODE);
    }
    return fault_of(KINEMATICS_CYCLE_OK, KINEMATICS_SETTINGS);
}

/*
 * Where a preset that is off is compensated, what is off may turn with any axis that is not at 0°.
 * It is told apart for axes that are measured alone.
 */
static kinematics_setting_t turned_unmeasured(const kinematics_job_t  *job,
                                              const kinematics_plan_t *plan)
{
    for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
        uint8_t incidence = kinematics_plan_incidence(axis);
        bool    is_turned = !kinematics_plan_is_there(job->settings.value[incidence], 0.0);
        if (job->machine.axes[axis].is_present && is_turned &&
            !kinematics_plan_measures(plan, axis)) {
            return (kinematics_setting_t)incidence;
        }
    }
    return KINEMATICS_SETTINGS;
}

/* The settings are sound, and the plan is made of them. */
static kinematics_cycle_fault_t check_plan(const kinematics_job_t  *job,
                                           const kinematics_plan_t *plan)
{
    bool may_follow = job->machine.has_advanced_functions_2 && !turns_a_coupling(job, plan);
    if (!kinematics_conditions_has_retract_height(job) && !may_follow) {
        return fault_of(KINEMATICS_CYCLE_ERR_RETRACT, KINEMATICS_Q408_RETRACT_HEIGHT);
    }
    if (job->machine.is_tcpm_on) {
        return fault_of(KINEMATICS_CYCLE_ERR_TCPM, KINEMATICS_SETTINGS);
    }
    if (job->machine.is_turning) {
        return fault_of(KINEMATICS_CYCLE_ERR_TURNING, KINEMATICS_SETTINGS);
    }
    if (kinematics_conditions_has_m_function(job) && !is_at_zero(job)) {
        return fault_of(KINEMATICS_CYCLE_ERR_NOT_AT_ZERO, KINEMATICS_SETTINGS);
    }
    kinematics_setting_t turned = turned_unmeasured(job, plan);
    if (job->settings.kind == KINEMATICS_COMPENSATE_PRESET && turned != KINEMATICS_SETTINGS) {
        return fault_of(KINEMATICS_CYCLE_ERR_INCIDENCE, turned);
    }
    return fault_of(plan->count > 0u ? KINEMATICS_CYCLE_OK : KINEMATICS_CYCLE_ERR_NOTHING,
                    KINEMATICS_SETTINGS);
}

/* Deleting the table moves nothing, so only the grid matters. */
static kinematics_cycle_fault_t check_grid(const kinematics_job_t *job, kinematics_plan_t *plan)
{
    const kinematics_grid_t *grid = &job->machine.grid;
    if (!kinematics_grid_is_sound(grid) || !kinematics_plan_grid_fits(grid, job->machine.axes)) {
        return fault_of(KINEMATICS_CYCLE_ERR_GRID, KINEMATICS_SETTINGS);
    }
    kinematics_plan_make_grid(plan, grid);
    return kinematics_conditions_mode(job) == KINEMATICS_MODE_DELETE
               ? fault_of(KINEMATICS_CYCLE_OK, KINEMATICS_SETTINGS)
               : check_plan(job, plan);
}

kinematics_cycle_fault_t kinematics_conditions_check(const kinematics_job_t *job,
                                                     kinematics_plan_t      *plan)
{
    kinematics_cycle_fault_t fault = check_settings(job);
    if (fault.error != KINEMATICS_CYCLE_OK) {
        return fault;
    }
    if (!is_sound(&job->machine)) {
        return fault_of(KINEMATICS_CYCLE_ERR_MACHINE, KINEMATICS_SETTINGS);
    }
    if (job->settings.kind == KINEMATICS_MEASURE_GRID) {
        return check_grid(job, plan);
    }
    kinematics_plan_make(plan, &job->settings, job->machine.axes,
                         !kinematics_conditions_has_m_function(job));
    return check_plan(job, plan);
}

/* ---- words ---- */

const char *kinematics_cycle_phrase(kinematics_cycle_error_t error)
{
    static const char *const PHRASES[] = {
        [KINEMATICS_CYCLE_OK] = "no error",
        [KINEMATICS_CYCLE_ERR_SETTING] = "a parameter is out of its limits",
        [KINEMATICS_CYCLE_ERR_NO_FEED] = "the feed for pre-positioning is 0",
        [KINEMATICS_CYCLE_ERR_NO_CLEARANCE] = "set-up clearance and SET_UP are both 0",
        [KINEMATICS_CYCLE_ERR_NO_CYCLE] = "the cycle needs KinematicsOpt (option 48)",
        [KINEMATICS_CYCLE_ERR_OPTION] = "modes 2 and 3 need KinematicsComp (option 52)",
        [KINEMATICS_CYCLE_ERR_NOT_STACKED] = "mode 3 needs one rotary axis upon another",
        [KINEMATICS_CYCLE_ERR_RETRACT] = "a retract height above 0 is needed: an axis with a Hirth "
                                         "coupling turns, or option 2 is not there",
        [KINEMATICS_CYCLE_ERR_TCPM] = "M128 or TCPM is on",
        [KINEMATICS_CYCLE_ERR_TURNING] = "FUNCTION MODE MILL is not active",
        [KINEMATICS_CYCLE_ERR_NOT_AT_ZERO] = "an M function positions the rotary axes, and not all "
                                             "of them are at 0°",
        [KINEMATICS_CYCLE_ERR_MACHINE] = "the machine's data are not sound",
        [KINEMATICS_CYCLE_ERR_INCIDENCE] = "cycle 452 wants every axis at 0° that it does not "
                                           "measure",
        [KINEMATICS_CYCLE_ERR_NO_COMP] = "cycle 453 needs KinematicsComp (option 52)",
        [KINEMATICS_CYCLE_ERR_GRID] = "cycle 453 needs a grid of the machine's maker: rising "
                                      "positions of its axes, 0° among them, on the grids of "
                                      "Hirth couplings, 2 to 75 in all",
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
