#include <string.h>

#include "cycle/kinematics_cycle.h"
#include "cycle/kinematics_requests.h"

/* The preset is the sphere's centre, or the probe has been put above it by hand. */
static void expect_sphere(kinematics_cycle_t *cycle)
{
    const kinematics_cycle_machine_t *machine = &cycle->job.machine;
    bool                              is_above = kinematics_conditions_presets_before(&cycle->job);
    double above = is_above ? kinematics_conditions_contact(&cycle->job) +
                                  kinematics_conditions_stand_off(&cycle->job)
                            : 0.0;

    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        cycle->expected_mm[i] = is_above ? machine->position_mm[i] - above * machine->tool_axis[i]
                                         : machine->preset_mm[i];
    }
    memcpy(cycle->sphere_mm, cycle->expected_mm, sizeof cycle->sphere_mm);
    memcpy(cycle->sphere_deg, cycle->stance.angle_deg, sizeof cycle->sphere_deg);
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
    memcpy(cycle->stance.angle_deg, machine->angle_deg, sizeof cycle->stance.angle_deg);
    memcpy(cycle->tool_axis, machine->tool_axis, sizeof cycle->tool_axis);
}

/* Check all and make the plan; nothing is asked for yet. */
static bool begin(kinematics_cycle_t *cycle, const kinematics_settings_t *settings,
                  const kinematics_cycle_machine_t *machine)
{
    memset(cycle, 0, sizeof *cycle); /* too large to be copied by way of the stack */
    cycle->job.settings = *settings;
    cycle->job.machine = *machine;
    place(cycle);
    cycle->fault = kinematics_conditions_check(&cycle->job, &cycle->plan);
    bool is_sound = cycle->fault.error == KINEMATICS_CYCLE_OK;
    cycle->state = is_sound ? KINEMATICS_CYCLE_RUNNING : KINEMATICS_CYCLE_FAILED;
    return is_sound;
}

static kinematics_cycle_error_t refuse(kinematics_cycle_t *cycle, kinematics_cycle_error_t error,
                                       kinematics_setting_t parameter)
{
    cycle->fault = (kinematics_cycle_fault_t){error, parameter};
    cycle->state = KINEMATICS_CYCLE_FAILED;
    return error;
}

kinematics_cycle_error_t kinematics_cycle_start(kinematics_cycle_t               *cycle,
                                                const kinematics_settings_t      *settings,
                                                const kinematics_cycle_machine_t *machine)
{
    if (!begin(cycle, settings, machine)) {
        return cycle->fault.error;
    }
    expect_sphere(cycle);
    if (kinematics_conditions_mode(&cycle->job) == KINEMATICS_MODE_DELETE) {
        (void)kinematics_request_begin(cycle, KINEMATICS_STEP_CLEAR, KINEMATICS_CYCLE_CLEAR);
    } else {
        (void)kinematics_request_begin(cycle, KINEMATICS_STEP_CANCEL_ROTATION,
                                       KINEMATICS_CYCLE_CANCEL_ROTATION);
    }
    return KINEMATICS_CYCLE_OK;
}

kinematics_cycle_error_t kinematics_cycle_start_measured(kinematics_cycle_t               *cycle,
                                                         const kinematics_settings_t      *settings,
                                                         const kinematics_cycle_machine_t *machine,
                                                         const kinematics_station_t       *stations,
                                                         uint8_t                           count)
{
    if (!begin(cycle, settings, machine)) {
        return cycle->fault.error;
    }
    if (count == 0u || count > KINEMATICS_STATIONS_MAX) {
        return refuse(cycle, KINEMATICS_CYCLE_ERR_NOTHING, KINEMATICS_SETTINGS);
    }
    for (uint8_t i = 0u; i < count; i++) {
        cycle->plan.stations[i] = stations[i];
        if (!kinematics_conditions_is_the_sphere(&cycle->job,
                                                 stations[i].radius_mm + machine->tip_radius_mm)) {
            return refuse(cycle, KINEMATICS_CYCLE_ERR_BALL_RADIUS, KINEMATICS_Q407_SPHERE_RADIUS);
        }
    }
    cycle->plan.count = cycle->plan.measured = count;
    (void)kinematics_request_begin(cycle, KINEMATICS_STEP_EVALUATE, KINEMATICS_CYCLE_EVALUATE);
    return KINEMATICS_CYCLE_OK;
}
