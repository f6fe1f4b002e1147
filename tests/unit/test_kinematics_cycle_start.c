/* Cycles 451 that do not start: each reason, named, and nothing moves. */
/* LINK: firmware/comp/kinematics_grid.c firmware/cycle/kinematics_conditions.c
 *       firmware/cycle/kinematics_cycle.c firmware/cycle/kinematics_cycle_start.c
 *       firmware/cycle/kinematics_plan.c firmware/cycle/kinematics_requests.c
 *       firmware/cycle/kinematics_stance.c
 *       firmware/cycle/kinematics_settings.c firmware/cycle/sphere_probe.c
 *       tests/support/cycle451_machine.c */
#include <math.h>
#include <string.h>

#include "cycle451_machine.h"
#include "unity.h"

static cycle451_machine_t machine;

void setUp(void)
{
    cycle451_set_up(&machine);
}

void tearDown(void)
{
}

static void check_refused(kinematics_cycle_error_t error, kinematics_setting_t parameter)
{
    kinematics_cycle_request_t request;

    TEST_ASSERT_EQUAL(error, cycle451_start(&machine));
    TEST_ASSERT_EQUAL(error, kinematics_cycle_fault(&machine.cycle)->error);
    TEST_ASSERT_EQUAL(parameter, kinematics_cycle_fault(&machine.cycle)->parameter);
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_FAILED, machine.cycle.state);
    TEST_ASSERT_FALSE(kinematics_cycle_take_request(&machine.cycle, &request));
}

static void check_starts(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(&machine));
}

void test_every_parameter_out_of_its_limits_is_named(void)
{
    for (uint32_t i = 0u; i < KINEMATICS_SETTINGS; i++) {
        const kinematics_setting_description_t *row = kinematics_settings_describe(i);

        cycle451_set_up(&machine);
        machine.settings.value[i] = row->low - 0.0001;
        check_refused(KINEMATICS_CYCLE_ERR_SETTING, (kinematics_setting_t)i);
        machine.settings.value[i] = row->high + 0.0001;
        check_refused(KINEMATICS_CYCLE_ERR_SETTING, (kinematics_setting_t)i);
        machine.settings.value[i] = NAN;
        check_refused(KINEMATICS_CYCLE_ERR_SETTING, (kinematics_setting_t)i);
    }
}

void test_without_kinematics_opt_there_is_no_cycle(void)
{
    machine.data.has_kinematics_opt = false;
    check_refused(KINEMATICS_CYCLE_ERR_NO_CYCLE, KINEMATICS_SETTINGS);
}

void test_without_a_feed_nothing_would_move(void)
{
    machine.data.tool_feed_mm_min = 0.0;
    kinematics_settings_set_word(&machine.settings, 253, KINEMATICS_FAUTO);
    check_refused(KINEMATICS_CYCLE_ERR_NO_FEED, KINEMATICS_Q253_FEED);
}

void test_without_a_clearance_a_touch_would_begin_touching(void)
{
    machine.data.set_up_mm = 0.0;
    check_refused(KINEMATICS_CYCLE_ERR_NO_CLEARANCE, KINEMATICS_Q320_CLEARANCE);
    cycle451_set(&machine, 320, 0.0001);
    check_starts();
}

void test_angles_need_kinematics_comp(void)
{
    machine.data.has_kinematics_comp = false;
    for (int mode = 0; mode <= 1; mode++) {
        cycle451_set(&machine, 406, mode);
        check_starts();
    }
    for (int mode = 2; mode <= 3; mode++) {
        cycle451_set(&machine, 406, mode);
        check_refused(KINEMATICS_CYCLE_ERR_OPTION, KINEMATICS_Q406_MODE);
    }
}

void test_the_datum_is_corrected_only_with_one_axis_upon_another(void)
{
    machine.data.is_stacked = false;
    cycle451_set(&machine, 406, 3);
    check_refused(KINEMATICS_CYCLE_ERR_NOT_STACKED, KINEMATICS_Q406_MODE);
    cycle451_set(&machine, 406, 2);
    check_starts();
}

void test_a_coupling_that_turns_needs_a_retract_height(void)
{
    machine.data.axes[ROTARY_C].grid_deg = 3.0;
    check_refused(KINEMATICS_CYCLE_ERR_RETRACT, KINEMATICS_Q408_RETRACT_HEIGHT);
    cycle451_set(&machine, 408, 0.0001);
    check_starts();

    cycle451_set(&machine, 408, 0);
    cycle451_set(&machine, 422, 0); /* now it stands still */
    check_starts();
    cycle451_set(&machine, 421, 30); /* and now it is brought to its incidence angle */
    check_refused(KINEMATICS_CYCLE_ERR_RETRACT, KINEMATICS_Q408_RETRACT_HEIGHT);
}

void test_without_option_2_a_retract_height_is_needed(void)
{
    machine.data.has_advanced_functions_2 = false;
    check_refused(KINEMATICS_CYCLE_ERR_RETRACT, KINEMATICS_Q408_RETRACT_HEIGHT);
    cycle451_set(&machine, 408, 80);
    check_starts();
}

void test_tcpm_must_be_off(void)
{
    machine.data.is_tcpm_on = true;
    check_refused(KINEMATICS_CYCLE_ERR_TCPM, KINEMATICS_SETTINGS);
}

void test_turning_mode_must_be_off(void)
{
    machine.data.is_turning = true;
    check_refused(KINEMATICS_CYCLE_ERR_TURNING, KINEMATICS_SETTINGS);
}

void test_with_an_m_function_all_axes_start_at_zero(void)
{
    machine.data.strobe_rot_ax_pos = 0; /* M0 is a function, too */
    check_starts();
    for (int axis = 0; axis < ROTARY_AXES; axis++) {
        machine.data.angle_deg[axis] = 0.001;
        check_refused(KINEMATICS_CYCLE_ERR_NOT_AT_ZERO, KINEMATICS_SETTINGS);
        machine.data.axes[axis].is_present = false; /* then it does not matter */
        check_starts();
        machine.data.axes[axis].is_present = true;
        machine.data.angle_deg[axis] = 0.0;
    }
    machine.data.strobe_rot_ax_pos = -1;
    machine.data.angle_deg[0] = 45.0;
    check_starts();
}

void test_without_a_position_there_is_nothing_to_do(void)
{
    cycle451_set(&machine, 418, 0);
    cycle451_set(&machine, 422, 0);
    check_refused(KINEMATICS_CYCLE_ERR_NOTHING, KINEMATICS_SETTINGS);

    cycle451_set(&machine, 414, 4);
    check_starts();
    machine.data.axes[ROTARY_A].is_present = false;
    check_refused(KINEMATICS_CYCLE_ERR_NOTHING, KINEMATICS_SETTINGS);
}

static void check_machine(double *value, double good, double bad)
{
    double before = *value;

    *value = good;
    check_starts();
    *value = bad;
    check_refused(KINEMATICS_CYCLE_ERR_MACHINE, KINEMATICS_SETTINGS);
    *value = NAN;
    check_refused(KINEMATICS_CYCLE_ERR_MACHINE, KINEMATICS_SETTINGS);
    *value = before;
}

void test_the_machine_is_checked(void)
{
    kinematics_cycle_machine_t *data = &machine.data;

    cycle451_set(&machine, 408, 100);
    check_machine(&data->tip_radius_mm, 0.0, -1e-9);
    check_machine(&data->global_clearance_mm, 0.0, -1e-9);
    check_machine(&data->max_modification_mm, 0.0, -1e-9);
    check_machine(&data->max_dev_cal_ball_mm, 0.0, -1e-9);
    check_machine(&data->probe_feed_max_mm_min, 1e-9, 0.0);
    check_machine(&data->axes[ROTARY_B].grid_deg, 359.9, 360.0);
    check_machine(&data->axes[ROTARY_B].grid_deg, 0.0, -1.0);
    check_machine(&data->angle_deg[ROTARY_B], -1000.0, INFINITY);
    check_machine(&data->position_mm[2], -1000.0, INFINITY);
    check_machine(&data->preset_mm[2], -1000.0, INFINITY);
    check_machine(&data->tool_axis[2], 1.0, 0.999);
    data->strobe_rot_ax_pos = -2;
    check_refused(KINEMATICS_CYCLE_ERR_MACHINE, KINEMATICS_SETTINGS);
}

void test_what_is_said_of_an_absent_axis_is_ignored(void)
{
    machine.data.axes[ROTARY_A] = (kinematics_plan_axis_t){false, NAN};
    machine.data.angle_deg[ROTARY_A] = NAN;
    check_starts();
}

void test_every_error_has_its_own_phrase(void)
{
    for (int i = KINEMATICS_CYCLE_OK; i <= KINEMATICS_CYCLE_ERR_REFUSED; i++) {
        for (int j = KINEMATICS_CYCLE_OK; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(0, strcmp(kinematics_cycle_phrase((kinematics_cycle_error_t)i),
                                            kinematics_cycle_phrase((kinematics_cycle_error_t)j)));
        }
    }
}

/* ---- what was measured before ---- */

static kinematics_cycle_error_t start_measured(uint8_t count, double radius_mm)
{
    kinematics_station_t stations[KINEMATICS_STATIONS_MAX] = {
        {{0.0}, 0u, 0u, 0, false, false, {0.0}, 0.0}};
    for (uint8_t i = 0u; i < count && i < KINEMATICS_STATIONS_MAX; i++) {
        stations[i].centre_mm[0] = (double)i;
        stations[i].radius_mm = radius_mm;
    }
    return kinematics_cycle_start_measured(&machine.cycle, &machine.settings, &machine.data,
                                           stations, count);
}

void test_what_was_measured_before_asks_at_once_for_the_evaluation(void)
{
    kinematics_cycle_request_t request;

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, start_measured(3u, 12.5));

    TEST_ASSERT_TRUE(kinematics_cycle_take_request(&machine.cycle, &request));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_EVALUATE, request.kind);
    TEST_ASSERT_EQUAL(3, kinematics_cycle_plan(&machine.cycle)->measured);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, kinematics_cycle_plan(&machine.cycle)->stations[2].centre_mm[0]);
}

void test_what_was_measured_before_obeys_the_same_rules(void)
{
    machine.data.is_tcpm_on = true;
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_ERR_TCPM, start_measured(3u, 12.5));
    machine.data.is_tcpm_on = false;
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_ERR_NOTHING, start_measured(0u, 12.5));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_ERR_NOTHING,
                      start_measured(KINEMATICS_STATIONS_MAX + 1u, 12.5));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, start_measured(KINEMATICS_STATIONS_MAX, 12.5));
    double off_mm = machine.data.max_dev_cal_ball_mm;
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, start_measured(3u, 12.5 + 0.99 * off_mm));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_ERR_BALL_RADIUS, start_measured(3u, 12.5 + 1.01 * off_mm));
}
