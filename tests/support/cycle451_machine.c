#include "cycle451_machine.h"

#include <math.h>
#include <string.h>

#include "unity.h"

void cycle451_set_up(cycle451_machine_t *machine)
{
    memset(machine, 0, sizeof *machine);
    kinematics_settings_reset(&machine->settings, KINEMATICS_MEASURE);
    machine->data = (kinematics_cycle_machine_t){
        .axes = {{true, 0.0}, {true, 0.0}, {true, 0.0}},
        .position_mm = {80.0, 20.0, 40.0 + 12.5 + 2.5 + 3.0},
        .preset_mm = {80.0, 20.0, 40.0},
        .tool_axis = {0.0, 0.0, 1.0},
        .tip_radius_mm = 2.5,
        .set_up_mm = 3.0,
        .probe_feed_max_mm_min = 600.0,
        .rapid_mm_min = 20000.0,
        .tool_feed_mm_min = 400.0,
        .global_feed_mm_min = 300.0,
        .global_clearance_mm = 7.0,
        .max_modification_mm = 1.0,
        .max_dev_cal_ball_mm = 0.1,
        .strobe_rot_ax_pos = -1,
        .has_kinematics_opt = true,
        .has_kinematics_comp = true,
        .has_advanced_functions_2 = true,
        .is_stacked = true,
    };
    memcpy(machine->sphere_mm, machine->data.preset_mm, sizeof machine->sphere_mm);
    machine->radius_mm = 12.5;
    machine->impossible_at = -1;
}

static void turn_about(int axis, double degrees, double *point)
{
    double angle = degrees * M_PI / 180.0;
    int    u = (axis + 1) % 3;
    int    v = (axis + 2) % 3;
    double before = point[u];
    point[u] = cos(angle) * before - sin(angle) * point[v];
    point[v] = sin(angle) * before + cos(angle) * point[v];
}

void cycle451_centre(const cycle451_machine_t *machine, const double *angle_deg, double *centre_mm)
{
    memcpy(centre_mm, machine->sphere_mm, sizeof machine->sphere_mm);
    for (int axis = 2; axis >= 0; axis--) {
        turn_about(axis, angle_deg[axis], centre_mm);
    }
}

void cycle451_set(cycle451_machine_t *machine, uint16_t id, double value)
{
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_OK,
                      kinematics_settings_set(&machine->settings, id, value));
}

kinematics_cycle_error_t cycle451_start(cycle451_machine_t *machine)
{
    machine->count = 0;
    memcpy(machine->angle_deg, machine->data.angle_deg, sizeof machine->angle_deg);
    return kinematics_cycle_start(&machine->cycle, &machine->settings, &machine->data);
}

static void touch(const cycle451_machine_t *machine, const kinematics_cycle_request_t *request,
                  double *touched_mm)
{
    double contact = machine->radius_mm + machine->data.tip_radius_mm;
    double centre[3];
    double along = 0.0;
    double square = 0.0;

    cycle451_centre(machine, machine->angle_deg, centre);
    for (int i = 0; i < 3; i++) {
        double off = centre[i] - request->target_mm[i];
        along += off * request->direction[i];
        square += off * off;
    }
    double travel = along - sqrt(contact * contact - square + along * along);
    for (int i = 0; i < 3; i++) {
        touched_mm[i] = request->target_mm[i] + travel * request->direction[i];
    }
}

/* Lost motion: the table lags behind its encoder. */
static void turn(cycle451_machine_t *machine, const kinematics_cycle_request_t *request,
                 double before_deg, kinematics_cycle_input_t *input)
{
    int    axis = (int)request->axis;
    double sense = request->angle_deg[axis] > before_deg ? 1.0 : -1.0;

    machine->angle_deg[axis] = request->angle_deg[axis] - sense * machine->backlash_deg[axis] / 2.0;
    cycle451_centre(machine, request->angle_deg, input->centre_mm);
    input->tool_axis[2] = 1.0;
}

static double encoder_of(const cycle451_machine_t *machine, int axis)
{
    for (int i = machine->count - 2; i >= 0; i--) {
        if (machine->log[i].kind != KINEMATICS_CYCLE_SET_PRESET) {
            return machine->log[i].angle_deg[axis];
        }
    }
    return machine->data.angle_deg[axis];
}

static void carry_out(cycle451_machine_t *machine, const kinematics_cycle_request_t *request,
                      kinematics_cycle_input_t *input)
{
    TEST_ASSERT_LESS_THAN(CYCLE451_LOG_MAX, machine->count);
    machine->log[machine->count++] = *request;
    *input = (kinematics_cycle_input_t){.outcome = KINEMATICS_CYCLE_CARRIED_OUT};
    if (machine->count - 1 == machine->impossible_at) {
        input->outcome = KINEMATICS_CYCLE_IMPOSSIBLE;
    } else if (request->kind == KINEMATICS_CYCLE_TOUCH) {
        touch(machine, request, input->touched_mm);
    } else if (request->kind == KINEMATICS_CYCLE_TURN ||
               request->kind == KINEMATICS_CYCLE_TURN_BY_M_FUNCTION) {
        turn(machine, request, encoder_of(machine, (int)request->axis), input);
    } else if (request->kind == KINEMATICS_CYCLE_EVALUATE) {
        input->change_mm = machine->change_mm;
    }
}

kinematics_cycle_state_t cycle451_run(cycle451_machine_t *machine)
{
    kinematics_cycle_request_t request;
    kinematics_cycle_input_t   input;

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(machine));
    while (kinematics_cycle_take_request(&machine->cycle, &request)) {
        carry_out(machine, &request, &input);
        kinematics_cycle_poll(&machine->cycle, &input);
    }
    return machine->cycle.state;
}

int cycle451_find(const cycle451_machine_t *machine, kinematics_cycle_request_kind_t kind, int from)
{
    for (int i = from; i < machine->count; i++) {
        if (machine->log[i].kind == kind) {
            return i;
        }
    }
    return -1;
}

int cycle451_asked(const cycle451_machine_t *machine, kinematics_cycle_request_kind_t kind)
{
    int asked = 0;
    for (int i = cycle451_find(machine, kind, 0); i >= 0; i = cycle451_find(machine, kind, i + 1)) {
        asked++;
    }
    return asked;
}
