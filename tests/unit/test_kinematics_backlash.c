/* Cycle 451 with Q432: from which side each axis comes to each station. */
/* LINK: firmware/comp/kinematics_grid.c firmware/cycle/kinematics_conditions.c
 *       firmware/cycle/kinematics_cycle.c firmware/cycle/kinematics_cycle_start.c
 *       firmware/cycle/kinematics_plan.c firmware/cycle/kinematics_requests.c
 *       firmware/cycle/kinematics_stance.c
 *       firmware/cycle/kinematics_settings.c firmware/cycle/sphere_probe.c
 *       tests/support/cycle451_machine.c */
#include "cycle451_machine.h"
#include "unity.h"

#define TINY_MM 1e-9
#define PLAY    0.02

static cycle451_machine_t machine;

void setUp(void)
{
    cycle451_set_up(&machine);
}

void tearDown(void)
{
}

static const kinematics_plan_t *run(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));
    return kinematics_cycle_plan(&machine.cycle);
}

static void check_turns_of_c(const double *expected, int n)
{
    int turn = -1;
    for (int i = 0; i < n; i++) {
        turn = cycle451_find(&machine, KINEMATICS_CYCLE_TURN, turn + 1);
        TEST_ASSERT_TRUE(turn >= 0);
        TEST_ASSERT_EQUAL(ROTARY_C, machine.log[turn].axis);
        TEST_ASSERT_EQUAL_DOUBLE(expected[i], machine.log[turn].angle_deg[ROTARY_C]);
    }
    TEST_ASSERT_EQUAL(-1, cycle451_find(&machine, KINEMATICS_CYCLE_TURN, turn + 1));
}

void test_each_position_is_approached_from_both_sides(void)
{
    const double expected[] = {-0.5, 0, -90.5, -90, -89.5, -90};
    cycle451_set(&machine, 418, 0);
    cycle451_set(&machine, 422, 1);
    cycle451_set(&machine, 432, 0.5);

    TEST_ASSERT_EQUAL(3, run()->measured);
    check_turns_of_c(expected, 6); /* B is not measured: it stays where it is */
}

void test_the_sign_of_q432_says_which_side_comes_first(void)
{
    const double expected[] = {0.5, 0, -89.5, -90, -90.5, -90};
    cycle451_set(&machine, 418, 0);
    cycle451_set(&machine, 422, 1);
    cycle451_set(&machine, 432, -0.5);

    TEST_ASSERT_EQUAL(3, run()->measured);
    check_turns_of_c(expected, 6);
}

/* Lost motion, half of it to each side: rising, an axis stands half of it too low. */
static void check_stands(double first_sense)
{
    const kinematics_plan_t *plan = run();
    for (int i = 0; i < plan->measured; i++) {
        const kinematics_station_t *station = &plan->stations[i];
        double                      angle_deg[ROTARY_AXES];
        double                      expected_mm[LINEAR_AXES];
        for (int axis = 0; axis < ROTARY_AXES; axis++) {
            bool   is_turned = station->is_second && station->axis == axis;
            double lag_deg = machine.backlash_deg[axis] / 2.0 * (is_turned ? -1.0 : 1.0);
            angle_deg[axis] = station->angle_deg[axis] - first_sense * lag_deg;
        }
        cycle451_centre(&machine, angle_deg, expected_mm);
        for (int k = 0; k < LINEAR_AXES; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, expected_mm[k], station->centre_mm[k]);
        }
    }
}

void test_an_axis_stands_alike_while_others_are_measured(void)
{
    cycle451_set(&machine, 414, 3);
    cycle451_set(&machine, 413, 10);
    cycle451_set(&machine, 421, -20);
    machine.backlash_deg[ROTARY_A] = PLAY;
    machine.backlash_deg[ROTARY_B] = 2.0 * PLAY;
    machine.backlash_deg[ROTARY_C] = 3.0 * PLAY;
    cycle451_set(&machine, 432, 0.5);
    check_stands(1.0);
    cycle451_set(&machine, 432, -0.5);
    check_stands(-1.0);
}

void test_a_preset_just_set_does_not_spare_an_approach(void)
{
    cycle451_set(&machine, 431, 1);
    cycle451_set(&machine, 432, 0.5);
    machine.backlash_deg[ROTARY_B] = PLAY;

    check_stands(1.0);
}
