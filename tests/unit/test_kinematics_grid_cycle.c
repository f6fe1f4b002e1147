/* Cycle 453, kinematics grid: what it takes, where it measures, what it asks for and refuses. */
/* LINK: firmware/comp/kinematics_grid.c firmware/cycle/kinematics_conditions.c
 *       firmware/cycle/kinematics_cycle.c firmware/cycle/kinematics_cycle_start.c
 *       firmware/cycle/kinematics_plan.c firmware/cycle/kinematics_requests.c
 *       firmware/cycle/kinematics_stance.c
 *       firmware/cycle/kinematics_settings.c firmware/cycle/sphere_probe.c
 *       tests/support/cycle451_machine.c */
#include "cycle451_machine.h"
#include "unity.h"

static cycle451_machine_t machine;

/* A at -30, 0 and 45, C at 0 and 90: six positions. */
void setUp(void)
{
    cycle451_set_up(&machine);
    kinematics_settings_reset(&machine.settings, KINEMATICS_MEASURE_GRID);
    machine.data.grid = (kinematics_grid_t){
        .count = {3u, 0u, 2u},
        .node_deg = {{-30.0, 0.0, 45.0}, {0.0}, {0.0, 90.0}},
    };
}

void tearDown(void)
{
}

static void check_refused(kinematics_cycle_error_t error)
{
    TEST_ASSERT_EQUAL(error, cycle451_start(&machine));
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_FAILED, machine.cycle.state);
    TEST_ASSERT_FALSE(machine.cycle.has_request);
}

void test_it_has_no_parameter_of_an_axis(void)
{
    for (uint32_t i = 0u; i < KINEMATICS_SETTINGS; i++) {
        const kinematics_setting_description_t *row = kinematics_settings_describe(i);
        bool                       is_own = row->id < 411u || row->id == 423u ||
                                            row->id == 431u; /* Q253, Q320, Q380, Q406 … Q408 */
        kinematics_setting_error_t expected =
            is_own ? KINEMATICS_SETTING_OK : KINEMATICS_SETTING_UNKNOWN;

        TEST_ASSERT_EQUAL(expected,
                          kinematics_settings_set(&machine.settings, row->id, row->initial));
        TEST_ASSERT_EQUAL(is_own, kinematics_settings_of(KINEMATICS_MEASURE_GRID,
                                                         (kinematics_setting_t)i) != NULL);
    }
}

void test_its_modes_are_delete_check_and_compensate(void)
{
    const double modes[] = {-1.0, 0.0, 1.0};
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(KINEMATICS_SETTING_OK,
                          kinematics_settings_set(&machine.settings, 406, modes[i]));
    }
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_LOW,
                      kinematics_settings_set(&machine.settings, 406, -2.0));
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_HIGH,
                      kinematics_settings_set(&machine.settings, 406, 2.0));
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_NOT_WHOLE,
                      kinematics_settings_set(&machine.settings, 406, -0.5));
}

void test_it_measures_the_reference_and_then_the_grid(void)
{
    const kinematics_plan_t *plan = kinematics_cycle_plan(&machine.cycle);
    const double             expected_deg[6][2] = {{0.0, 0.0},  {-30.0, 0.0}, {-30.0, 90.0},
                                                   {0.0, 90.0}, {45.0, 0.0},  {45.0, 90.0}};

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(6, plan->measured);
    for (int i = 0; i < 6; i++) {
        double centre_mm[3];
        cycle451_centre(&machine, plan->stations[i].angle_deg, centre_mm);
        TEST_ASSERT_EQUAL_DOUBLE(expected_deg[i][0], plan->stations[i].angle_deg[0]);
        TEST_ASSERT_EQUAL_DOUBLE(expected_deg[i][1], plan->stations[i].angle_deg[2]);
        TEST_ASSERT_EQUAL(i == 0, plan->stations[i].is_reference);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, centre_mm[0], plan->stations[i].centre_mm[0]);
    }
}

void test_a_check_changes_nothing(void)
{
    machine.change_mm = 9.0;

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_EVALUATE));
    TEST_ASSERT_EQUAL(0, cycle451_asked(&machine, KINEMATICS_CYCLE_APPLY));
    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_TILT));
}

void test_compensating_applies_and_waits_above_the_limit(void)
{
    cycle451_set(&machine, 406, 1.0);
    machine.change_mm = 1.0001;

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_ACKNOWLEDGE));
    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_APPLY));
}

void test_the_preset_may_be_set_before_and_after(void)
{
    cycle451_set(&machine, 431, 3.0);

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(2, cycle451_asked(&machine, KINEMATICS_CYCLE_SET_PRESET));
}

void test_deleting_moves_and_touches_nothing(void)
{
    cycle451_set(&machine, 406, -1.0);
    cycle451_set(&machine, 431, 3.0);

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));

    TEST_ASSERT_EQUAL(1, machine.count);
    TEST_ASSERT_EQUAL(1, cycle451_asked(&machine, KINEMATICS_CYCLE_CLEAR));
}

void test_deleting_wants_no_retract_height(void)
{
    machine.data.has_advanced_functions_2 = false;
    check_refused(KINEMATICS_CYCLE_ERR_RETRACT);

    cycle451_set(&machine, 406, -1.0);
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(&machine));
}

void test_it_needs_both_options(void)
{
    machine.data.has_kinematics_comp = false;
    check_refused(KINEMATICS_CYCLE_ERR_NO_COMP);

    machine.data.has_kinematics_opt = false;
    check_refused(KINEMATICS_CYCLE_ERR_NO_CYCLE);
}

void test_it_needs_a_grid_that_is_sound(void)
{
    machine.data.grid.node_deg[0][1] = 1.0;
    check_refused(KINEMATICS_CYCLE_ERR_GRID);

    machine.data.grid = (kinematics_grid_t){.count = {0u, 0u, 0u}};
    check_refused(KINEMATICS_CYCLE_ERR_GRID);
}

void test_the_axes_of_the_grid_are_there(void)
{
    machine.data.axes[ROTARY_C].is_present = false;

    check_refused(KINEMATICS_CYCLE_ERR_GRID);
}

void test_a_coupling_takes_every_node(void)
{
    cycle451_set(&machine, 408, 50.0);
    machine.data.axes[ROTARY_A].grid_deg = 15.0;
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(&machine));

    machine.data.axes[ROTARY_A].grid_deg = 10.0;
    check_refused(KINEMATICS_CYCLE_ERR_GRID);
}

void test_tcpm_and_turning_mode_are_refused(void)
{
    machine.data.is_tcpm_on = true;
    check_refused(KINEMATICS_CYCLE_ERR_TCPM);

    machine.data.is_tcpm_on = false;
    machine.data.is_turning = true;
    check_refused(KINEMATICS_CYCLE_ERR_TURNING);
}

void test_the_other_cycles_look_at_no_grid(void)
{
    kinematics_settings_reset(&machine.settings, KINEMATICS_MEASURE);
    machine.data.grid.count[0] = 255u;

    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_OK, cycle451_start(&machine));
}
