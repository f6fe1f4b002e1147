/* Cycle 452, preset compensation: what it measures, corrects and refuses, beside cycle 451. */
/* LINK: firmware/comp/kinematics_grid.c firmware/cycle/kinematics_conditions.c
 *       firmware/cycle/kinematics_cycle.c firmware/cycle/kinematics_cycle_start.c
 *       firmware/cycle/kinematics_plan.c firmware/cycle/kinematics_requests.c
 *       firmware/cycle/kinematics_stance.c
 *       firmware/cycle/kinematics_settings.c firmware/cycle/sphere_probe.c
 *       tests/support/cycle451_machine.c */
#include "cycle451_machine.h"
#include "unity.h"

static cycle451_machine_t machine;

void setUp(void)
{
    cycle451_set_up(&machine);
    kinematics_settings_reset(&machine.settings, KINEMATICS_COMPENSATE_PRESET);
}

void tearDown(void)
{
}

static void measure_no_axis(void)
{
    cycle451_set(&machine, 414, 0.0);
    cycle451_set(&machine, 418, 0.0);
    cycle451_set(&machine, 422, 0.0);
}

static void check_refused(kinematics_cycle_error_t error, kinematics_setting_t parameter)
{
    TEST_ASSERT_EQUAL(error, cycle451_start(&machine));
    TEST_ASSERT_EQUAL(parameter, kinematics_cycle_fault(&machine.cycle)->parameter);
}

void test_it_has_neither_a_mode_nor_a_preset_to_set(void)
{
    for (uint32_t i = 0u; i < KINEMATICS_SETTINGS; i++) {
        const kinematics_setting_description_t *row = kinematics_settings_describe(i);
        kinematics_setting_error_t              expected =
            row->id == 406u || row->id == 431u ? KINEMATICS_SETTING_UNKNOWN : KINEMATICS_SETTING_OK;

        TEST_ASSERT_EQUAL(expected,
                          kinematics_settings_set(&machine.settings, row->id, row->initial));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_UNKNOWN,
                      kinematics_settings_set_word(&machine.settings, 406, KINEMATICS_PREDEF));
}

void test_it_corrects_and_leaves_the_preset(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_EVALUATE));
    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_APPLY));
    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_TILT));
    TEST_ASSERT_EQUAL(0, cycle451_asked(&machine, KINEMATICS_CYCLE_SET_PRESET));
}

void test_a_change_above_the_limit_waits_for_its_acknowledgement(void)
{
    machine.change_mm = 1.0001;

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_ACKNOWLEDGE));
}

void test_it_finds_the_sphere_off_the_preset(void)
{
    const double *centre_mm = machine.cycle.plan.stations[0].centre_mm;
    machine.sphere_mm[0] += 0.4;
    machine.sphere_mm[2] -= 0.3;

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 80.4, centre_mm[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 39.7, centre_mm[2]);
}

void test_without_an_axis_it_measures_the_sphere_once(void)
{
    measure_no_axis();

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(1, kinematics_cycle_plan(&machine.cycle)->measured);
    TEST_ASSERT_EQUAL(0, kinematics_cycle_plan(&machine.cycle)->stations[0].serves);
    TEST_ASSERT_EQUAL(5, cycle451_asked(&machine, KINEMATICS_CYCLE_TOUCH));
    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_APPLY));
}

void test_cycle_451_without_an_axis_has_nothing_to_do(void)
{
    kinematics_settings_reset(&machine.settings, KINEMATICS_MEASURE);
    measure_no_axis();

    check_refused(KINEMATICS_CYCLE_ERR_NOTHING, KINEMATICS_SETTINGS);
}

void test_an_axis_that_it_does_not_measure_stands_at_0(void)
{
    cycle451_set(&machine, 413, 0.0001);
    check_refused(KINEMATICS_CYCLE_ERR_INCIDENCE, KINEMATICS_Q413_INCIDENCE_A);

    cycle451_set(&machine, 414, 2.0);
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(&machine));
}

void test_each_turned_axis_is_named_by_its_own_parameter(void)
{
    measure_no_axis();
    cycle451_set(&machine, 421, -90.0);
    check_refused(KINEMATICS_CYCLE_ERR_INCIDENCE, KINEMATICS_Q421_INCIDENCE_C);

    cycle451_set(&machine, 417, 30.0);
    check_refused(KINEMATICS_CYCLE_ERR_INCIDENCE, KINEMATICS_Q417_INCIDENCE_B);
}

void test_an_axis_that_is_not_there_may_be_told_anything(void)
{
    machine.data.axes[ROTARY_A].is_present = false;
    cycle451_set(&machine, 413, 45.0);

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(&machine));
}

void test_cycle_451_leaves_an_axis_where_it_is_told(void)
{
    kinematics_settings_reset(&machine.settings, KINEMATICS_MEASURE);
    cycle451_set(&machine, 413, 45.0);

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(&machine));
}
