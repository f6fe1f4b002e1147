/* Measuring positions and stations: the document's examples, the grid, the reference, backlash. */
/* LINK: firmware/comp/kinematics_grid.c firmware/cycle/kinematics_plan.c
 *       firmware/cycle/kinematics_settings.c */
#include <math.h>

#include "cycle/kinematics_plan.h"
#include "unity.h"

#define TINY_DEG 1e-9

static kinematics_settings_t  settings;
static kinematics_plan_axis_t axes[ROTARY_AXES];
static kinematics_plan_t      plan;

void setUp(void)
{
    kinematics_settings_reset(&settings, KINEMATICS_MEASURE);
    for (int i = 0; i < ROTARY_AXES; i++) {
        axes[i] = (kinematics_plan_axis_t){.is_present = true};
    }
}

void tearDown(void)
{
}

static void check_positions(double start, double end, uint8_t points, double grid,
                            const double *expected, uint8_t count)
{
    double positions[KINEMATICS_POINTS_MAX];

    TEST_ASSERT_EQUAL(count, kinematics_plan_positions(start, end, points, grid, positions));
    for (uint8_t i = 0u; i < count; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, expected[i], positions[i]);
    }
}

#define CHECK_POSITIONS(start, end, points, grid, ...)                    \
    do {                                                                  \
        const double expected_[] = {__VA_ARGS__};                         \
        check_positions((start), (end), (points), (grid), expected_,      \
                        (uint8_t)(sizeof expected_ / sizeof *expected_)); \
    } while (false)

void test_the_worked_examples_of_the_document(void)
{
    CHECK_POSITIONS(90, -90, 4, 0, 90, 30, -30, -90);
    CHECK_POSITIONS(90, 270, 4, 0, 90, 150, 210, 270);
    CHECK_POSITIONS(-30, 90, 4, 3, -30, 9, 51, 90);
}

void test_a_full_turn_is_measured_at_three_positions(void)
{
    CHECK_POSITIONS(90, 270, 3, 0, 90, 180, 270);
}

void test_a_position_at_zero_is_the_reference_and_left_out(void)
{
    CHECK_POSITIONS(-90, 90, 3, 0, -90, 90);
    CHECK_POSITIONS(0, 90, 2, 0, 90);
    check_positions(0, 0, 1, 0, NULL, 0);
    CHECK_POSITIONS(-0.0001, 0.0001, 3, 0, -0.0001, 0.0001);
}

void test_what_the_grid_rounds_to_zero_or_a_full_turn_is_the_reference_too(void)
{
    CHECK_POSITIONS(-40, 41, 4, 30, -30, 30); /* −40, −13, 14, 41 */
    CHECK_POSITIONS(180, 359.9999, 2, 3, 180);
    CHECK_POSITIONS(-180, -359.9999, 2, 3, -180);
}

void test_one_point_stands_at_the_start_and_none_nowhere(void)
{
    CHECK_POSITIONS(45, 90, 1, 0, 45);
    check_positions(45, 90, 0, 0, NULL, 0);
}

void test_twelve_points_fit(void)
{
    double positions[KINEMATICS_POINTS_MAX];

    TEST_ASSERT_EQUAL(12, kinematics_plan_positions(10, 340, 12, 0, positions));
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, 10, positions[0]);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, 340, positions[11]);
}

void test_a_tie_goes_away_from_zero_whatever_rounding_did(void)
{
    CHECK_POSITIONS(4.5, -4.5, 2, 3, 6, -6);
    CHECK_POSITIONS(0.3, 0.7, 2, 0.2, 0.4, 0.8);      /* 0.3 / 0.2 comes out below 1.5 */
    CHECK_POSITIONS(0.3, 0.9, 3, 0.4, 0.4, 0.8, 0.8); /* 0.3, 0.6 (a tie), 0.9 */
}

void test_the_same_position_twice_is_no_error(void)
{
    CHECK_POSITIONS(90, -270, 2, 0, 90, -270);
    CHECK_POSITIONS(30, 30, 3, 0, 30, 30, 30);
}

/* ---- stations ---- */

static void set(uint16_t id, double value)
{
    TEST_ASSERT_EQUAL(KINEMATICS_SETTING_OK, kinematics_settings_set(&settings, id, value));
}

static void measure_only(uint16_t points_id, double points)
{
    set(414, 0);
    set(418, 0);
    set(422, 0);
    set(points_id, points);
}

static void check_station(uint8_t index, double a, double b, double c, int approach)
{
    const kinematics_station_t *station = &plan.stations[index];

    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, a, station->angle_deg[ROTARY_A]);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, b, station->angle_deg[ROTARY_B]);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, c, station->angle_deg[ROTARY_C]);
    TEST_ASSERT_EQUAL(approach, station->approach);
}

static void make(void)
{
    kinematics_plan_make(&plan, &settings, axes, true);
}

void test_the_first_program_measures_b_then_c_and_the_reference_once(void)
{
    make();

    TEST_ASSERT_EQUAL(5, plan.count);
    TEST_ASSERT_EQUAL(0, plan.measured);
    check_station(0, 0, 0, 0, 0);
    check_station(1, 0, -90, 0, 0);
    check_station(2, 0, 90, 0, 0);
    check_station(3, 0, 0, -90, 0);
    check_station(4, 0, 0, 90, 0);
    TEST_ASSERT_TRUE(plan.stations[0].is_reference);
    TEST_ASSERT_FALSE(plan.stations[1].is_reference);
    TEST_ASSERT_EQUAL(1u << ROTARY_B | 1u << ROTARY_C, plan.stations[0].serves);
    TEST_ASSERT_EQUAL(1u << ROTARY_B, plan.stations[1].serves);
    TEST_ASSERT_EQUAL(1u << ROTARY_C, plan.stations[4].serves);
}

void test_other_axes_stand_at_their_incidence_angles(void)
{
    measure_only(418, 2);
    set(413, 20);
    set(421, -45);
    set(417, 77); /* of the measured axis itself: does not matter */
    make();

    TEST_ASSERT_EQUAL(3, plan.count);
    check_station(0, 20, 0, -45, 0);
    check_station(1, 20, -90, -45, 0);
    check_station(2, 20, 90, -45, 0);
}

void test_references_at_other_incidence_angles_are_each_measured(void)
{
    set(421, 30); /* of C while B is measured */
    make();

    TEST_ASSERT_EQUAL(6, plan.count);
    check_station(0, 0, 0, 30, 0);
    check_station(3, 0, 0, 0, 0);
    TEST_ASSERT_TRUE(plan.stations[3].is_reference);
}

void test_a_position_of_one_axis_is_not_the_reference_of_another(void)
{
    set(415, 30);
    set(418, 1);
    set(417, 30); /* of B while C is measured */
    make();

    TEST_ASSERT_EQUAL(5, plan.count);
    check_station(1, 0, 30, 0, 0);
    check_station(2, 0, 30, 0, 0);
    TEST_ASSERT_EQUAL(1u << ROTARY_B, plan.stations[1].serves);
    TEST_ASSERT_EQUAL(1u << ROTARY_C, plan.stations[2].serves);
    TEST_ASSERT_TRUE(plan.stations[2].is_reference);
}

void test_incidence_angles_of_a_coupling_are_on_its_grid(void)
{
    measure_only(418, 1);
    axes[ROTARY_A].grid_deg = 3.0;
    set(413, 10);
    make();

    check_station(0, 9, 0, 0, 0);
}

void test_axes_that_are_not_there_are_ignored(void)
{
    axes[ROTARY_B].is_present = false;
    set(414, 1);
    set(417, 33); /* incidence of the absent one */
    make();

    TEST_ASSERT_EQUAL(4, plan.count);
    check_station(0, 0, 0, 0, 0);
    check_station(1, -90, 0, 0, 0);
    check_station(2, 0, 0, -90, 0);
}

void test_an_axis_with_nothing_but_zero_is_not_measured(void)
{
    measure_only(422, 1);
    set(419, 0);
    make();

    TEST_ASSERT_EQUAL(0, plan.count);
}

void test_backlash_takes_two_approaches_and_one_reference(void)
{
    measure_only(422, 2);
    set(432, 0.5);
    make();

    TEST_ASSERT_EQUAL(5, plan.count);
    check_station(0, 0, 0, 0, 1);
    check_station(1, 0, 0, -90, 1);
    check_station(2, 0, 0, -90, -1);
    check_station(3, 0, 0, 90, 1);
    check_station(4, 0, 0, 90, -1);
    for (int i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL(i == 2 || i == 4, plan.stations[i].is_second);
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.5, plan.side_deg[ROTARY_C]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, plan.side_deg[ROTARY_B]); /* not measured */
}

void test_a_negative_backlash_angle_begins_from_the_other_side(void)
{
    measure_only(422, 1);
    set(432, -3);
    make();

    TEST_ASSERT_EQUAL(3, plan.count);
    check_station(1, 0, 0, -90, -1);
    TEST_ASSERT_EQUAL_DOUBLE(-3.0, plan.side_deg[ROTARY_C]);
    check_station(2, 0, 0, -90, 1);
}

void test_neither_coupling_nor_m_function_measures_backlash(void)
{
    measure_only(422, 2);
    set(432, 0.5);
    kinematics_plan_make(&plan, &settings, axes, false);
    TEST_ASSERT_EQUAL(3, plan.count);
    check_station(1, 0, 0, -90, 0);

    axes[ROTARY_C].grid_deg = 1.0;
    make();
    TEST_ASSERT_EQUAL(3, plan.count);
    check_station(1, 0, 0, -90, 0);
}

void test_the_largest_plan_fits(void)
{
    for (uint16_t id = 411; id <= 419; id = (uint16_t)(id + 4)) {
        set(id, 10);
        set((uint16_t)(id + 1), 120);
        set((uint16_t)(id + 2), id == 415 ? 0 : 5); /* three different references */
        set((uint16_t)(id + 3), 12);
    }
    set(432, 1);
    make();

    TEST_ASSERT_EQUAL(KINEMATICS_STATIONS_MAX, plan.count);
}
