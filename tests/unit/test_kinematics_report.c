/* What cycle 451 reports: scatter, backlash, Q141 to Q149, with planted errors. */
/* LINK: firmware/comp/kinematics_grid.c firmware/cycle/kinematics_conditions.c
 *       firmware/cycle/kinematics_cycle.c firmware/cycle/kinematics_cycle_start.c
 *       firmware/cycle/kinematics_plan.c firmware/cycle/kinematics_requests.c
 *       firmware/cycle/kinematics_stance.c
 *       firmware/cycle/kinematics_report.c firmware/cycle/kinematics_settings.c
 *       firmware/cycle/sphere_probe.c tests/support/cycle451_machine.c */
#include <math.h>
#include <string.h>

#include "cycle/kinematics_report.h"
#include "cycle451_machine.h"
#include "unity.h"

#define TINY_MM  1e-9
#define TINY_DEG 1e-6

static cycle451_machine_t       machine;
static kinematics_report_t      report;
static kinematics_expectation_t expected;
static double                   before_mm[KINEMATICS_STATIONS_MAX][LINEAR_AXES];
static double                   after_mm[KINEMATICS_STATIONS_MAX][LINEAR_AXES];
static double                   slope_mm[KINEMATICS_STATIONS_MAX][LINEAR_AXES];

/* The incidence angles are 0; nothing is optimised. */
void setUp(void)
{
    cycle451_set_up(&machine);
    expected = (kinematics_expectation_t){
        .before_mm = (const double (*)[LINEAR_AXES])before_mm,
        .after_mm = (const double (*)[LINEAR_AXES])after_mm,
        .slope_mm = (const double (*)[LINEAR_AXES])slope_mm,
        .offset_mm = {0.01, -0.02, 0.03},
    };
}

void tearDown(void)
{
}

static const kinematics_plan_t *plan(void)
{
    return kinematics_cycle_plan(&machine.cycle);
}

/* Axis × place, the axes about X, Y and Z through 0 and all but one at 0. */
static void tell_slope(const kinematics_station_t *station, double *slope)
{
    int u = (station->axis + 1) % 3;
    int v = (station->axis + 2) % 3;

    slope[station->axis] = 0.0;
    slope[u] = -station->centre_mm[v];
    slope[v] = station->centre_mm[u];
}

/* Expect what was measured, `off_mm` away along X before and along Z after the optimisation. */
static void expect(double off_before_mm, double off_after_mm)
{
    for (int i = 0; i < plan()->measured; i++) {
        memcpy(before_mm[i], plan()->stations[i].centre_mm, sizeof before_mm[i]);
        memcpy(after_mm[i], plan()->stations[i].centre_mm, sizeof after_mm[i]);
        before_mm[i][0] += off_before_mm;
        after_mm[i][2] += off_after_mm;
        tell_slope(&plan()->stations[i], slope_mm[i]);
    }
}

static void measure(void)
{
    TEST_ASSERT_EQUAL(KINEMATICS_CYCLE_DONE, cycle451_run(&machine));
    expect(0.0, 0.0);
}

static void make(void)
{
    kinematics_report_make(&report, plan(), &expected);
}

static void check_q(int id, double value)
{
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, value, report.q_mm[id - 141]);
}

void test_the_first_program_leaves_a_unmeasured_and_nothing_optimised(void)
{
    measure();
    expect(0.004, 0.001);
    make();

    check_q(141, -1);
    check_q(142, 0.004);
    check_q(143, 0.004);
    for (int id = 144; id <= 146; id++) {
        check_q(id, -1);
    }
    check_q(147, 0.01);
    check_q(148, -0.02);
    check_q(149, 0.03);
}

void test_an_optimisation_shows_what_is_left(void)
{
    expected.is_optimised = true;
    measure();
    expect(0.004, 0.001);
    make();

    check_q(144, -1);
    check_q(145, 0.001);
    check_q(146, 0.001);
}

void test_scatter_is_a_root_mean_square_and_the_reference_does_not_count(void)
{
    measure();
    before_mm[1][0] += 0.003; /* B at −90° */
    before_mm[2][1] += 0.001;
    before_mm[2][2] -= 0.001;
    before_mm[0][0] += 1.0; /* the reference */
    make();

    check_q(142, sqrt((9e-6 + 2e-6) / 2));
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, 0.003, report.axes[ROTARY_B].greatest_before_mm);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, 0.0, report.axes[ROTARY_B].greatest_after_mm);
    TEST_ASSERT_EQUAL(2, report.axes[ROTARY_B].positions);
}

void test_of_one_position_the_scatter_is_its_error_in_space(void)
{
    cycle451_set(&machine, 422, 1);
    measure();
    before_mm[3][0] += 0.003;
    before_mm[3][1] += 0.004;
    make();

    TEST_ASSERT_EQUAL(1, report.axes[ROTARY_C].positions);
    check_q(143, 0.005);
}

void test_the_radius_is_that_of_the_circle_of_each_axis(void)
{
    cycle451_set(&machine, 414, 3);
    measure();
    make();

    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, hypot(20, 40), report.axes[ROTARY_A].radius_mm);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, hypot(80, 40), report.axes[ROTARY_B].radius_mm);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, hypot(80, 20), report.axes[ROTARY_C].radius_mm);
}

void test_positioning_errors_are_those_along_the_motion(void)
{
    measure();
    expect(0.0, 0.01); /* along Z: across the motion of C */
    double off_mm[2] = {0.003, -0.001};
    for (int i = 0; i < 2; i++) { /* C at −90° and 90° */
        for (int k = 0; k < 3; k++) {
            after_mm[3 + i][k] -= off_mm[i] * slope_mm[3 + i][k] / hypot(80, 20);
        }
    }
    make();

    double deg_per_mm = 180.0 / M_PI / hypot(80, 20);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, 0.001 * deg_per_mm, report.axes[ROTARY_C].positioning_deg);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, sqrt(2) * 0.002 * deg_per_mm,
                              report.axes[ROTARY_C].positioning_scatter_deg);
}

void test_one_position_has_no_positioning_scatter(void)
{
    cycle451_set(&machine, 422, 1);
    measure();
    expect(0.0, 0.01);
    make();

    TEST_ASSERT_EQUAL_DOUBLE(0.0, report.axes[ROTARY_C].positioning_scatter_deg);
}

void test_a_sphere_in_the_axis_has_no_angle(void)
{
    machine.sphere_mm[0] = machine.data.preset_mm[0] = 0.0;
    machine.sphere_mm[1] = machine.data.preset_mm[1] = 0.0;
    cycle451_set(&machine, 418, 0);
    measure();
    memset(slope_mm, 0, sizeof slope_mm);
    make();

    TEST_ASSERT_EQUAL_DOUBLE(0.0, report.axes[ROTARY_C].radius_mm);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, report.axes[ROTARY_C].positioning_deg);
}

/* ---- backlash ---- */

static void check_backlash(double angle_range_deg, double planted_deg)
{
    cycle451_set(&machine, 414, 3);
    cycle451_set(&machine, 418, 5);
    cycle451_set(&machine, 432, angle_range_deg);
    machine.backlash_deg[ROTARY_A] = planted_deg;
    machine.backlash_deg[ROTARY_C] = 2.0 * planted_deg;
    measure();
    make();

    for (int axis = 0; axis < ROTARY_AXES; axis++) {
        TEST_ASSERT_TRUE(report.axes[axis].has_backlash);
    }
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, planted_deg, report.axes[ROTARY_A].backlash_deg);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, 0.0, report.axes[ROTARY_B].backlash_deg);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, 2.0 * planted_deg, report.axes[ROTARY_C].backlash_deg);
    TEST_ASSERT_EQUAL(4, report.axes[ROTARY_B].positions); /* each counts once, 0° not at all */
}

void test_planted_backlash_comes_back_from_either_side(void)
{
    check_backlash(0.5, 0.02);
    check_backlash(-0.5, 0.02);
    check_backlash(3.0, 0.001);
}

void test_without_q432_there_is_no_backlash(void)
{
    machine.backlash_deg[ROTARY_C] = 0.02;
    measure();
    make();

    TEST_ASSERT_FALSE(report.axes[ROTARY_C].has_backlash);
}

static bool has_backlash_at(double radius_mm)
{
    machine.sphere_mm[0] = machine.data.preset_mm[0] = radius_mm;
    machine.sphere_mm[1] = machine.data.preset_mm[1] = 0.0;
    cycle451_set(&machine, 418, 0);
    cycle451_set(&machine, 432, 1);
    measure();
    make();
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, radius_mm, report.axes[ROTARY_C].radius_mm);
    return report.axes[ROTARY_C].has_backlash;
}

void test_backlash_needs_a_circle_of_1_mm(void)
{
    TEST_ASSERT_TRUE(has_backlash_at(1.0 + 1e-6));
    TEST_ASSERT_FALSE(has_backlash_at(1.0 - 1e-6));
}

void test_start_and_end_alike_are_pairs_of_their_own(void)
{
    cycle451_set(&machine, 418, 0);
    cycle451_set(&machine, 419, 90); /* to +90° as well, as Q420 has it: twice the same */
    cycle451_set(&machine, 432, 0.5);
    machine.backlash_deg[ROTARY_C] = 0.02;
    measure();
    make();

    TEST_ASSERT_EQUAL(5, plan()->measured);
    TEST_ASSERT_EQUAL(2, report.axes[ROTARY_C].positions);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_DEG, 0.02, report.axes[ROTARY_C].backlash_deg);
}

void test_nothing_measured_is_nothing_reported(void)
{
    kinematics_plan_t empty = {.count = 5, .measured = 0};

    kinematics_report_make(&report, &empty, &expected);
    for (int id = 141; id <= 146; id++) {
        check_q(id, -1);
    }
}
