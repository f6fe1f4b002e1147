/* What of a machine may be fitted, and how much the coordinate along the tool counts. */
/* LINK: firmware/comp/kinematics*.c */
#include <math.h>
#include <string.h>

#include "comp/kinematics.h"
#include "unity.h"

#define RAD_PER_DEG 0.017453292519943295
#define ARCSEC      (RAD_PER_DEG / 3600.0)
#define MAX         32

static kinematics_machine_t machine;
static kinematics_point_t   points[MAX];
static kinematics_result_t  result;

static void set_axis(int32_t j, char letter, int32_t is_head)
{
    kinematics_axis_t *axis = &machine.axes[j];
    axis->letter = letter;
    axis->is_head = is_head;
    axis->direction[letter - 'A'] = 1.0;
    machine.axes_count = j + 1;
}

void setUp(void)
{
    memset(&machine, 0, sizeof machine);
    memset(points, 0, sizeof points);
}

void tearDown(void)
{
}

static void turn(double *x, double *y, double angle_rad)
{
    double old = *x;
    *x = cos(angle_rad) * old - sin(angle_rad) * *y;
    *y = sin(angle_rad) * old + cos(angle_rad) * *y;
}

/* A tilts about X and carries C; at the reading 0 it stands at `zero_rad`. */
static int32_t play_ac(double zero_rad)
{
    int32_t n = 0;
    set_axis(0, 'A', 0);
    set_axis(1, 'C', 0);
    for (double a = -60.0; a < 61.0; a += 40.0) {
        for (double c = 0.0; c < 359.0; c += 60.0) {
            double *at = points[n].position_mm;
            at[0] = 120.0;
            at[1] = 10.0;
            at[2] = 40.0;
            turn(&at[0], &at[1], c * RAD_PER_DEG);
            turn(&at[1], &at[2], a * RAD_PER_DEG + zero_rad);
            points[n].angle_deg[0] = a;
            points[n++].angle_deg[1] = c;
        }
    }
    return n;
}

static const kinematics_parameter_t *parameter(const char *name)
{
    for (int32_t i = 0; i < result.parameters_count; i++) {
        if (strcmp(result.parameters[i].name, name) == 0) {
            return &result.parameters[i];
        }
    }
    TEST_FAIL_MESSAGE(name);
    return NULL;
}

static double residual_um(int32_t n)
{
    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_fit(&machine, points, n, &result));
    return result.residual_um * sqrt((double)result.freedom);
}

static void hold_tilts(int32_t hold)
{
    for (int32_t j = 0; j < machine.axes_count; j++) {
        machine.axes[j].is_held[2] = hold;
        machine.axes[j].is_held[3] = hold;
    }
}

/* Offsets take as much of the tilt of C as they can, and not a micrometre more. */
void test_with_tilts_held_the_offsets_are_the_best_there_are(void)
{
    static const char *const OFFSETS[] = {"YOA", "ZOA", "XOC", "YOC"};
    int32_t                  n = play_ac(50.0 * ARCSEC); /* of C, as A's zero is as believed */
    hold_tilts(1);
    double least_um = residual_um(n);

    TEST_ASSERT_TRUE(least_um > 10.0);
    TEST_ASSERT_EQUAL(KINEMATICS_HELD, parameter("AOC")->state);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, parameter("AOC")->value);
    for (int i = 0; i < 4; i++) {
        kinematics_machine_t before = machine;
        kinematics_axis_t   *axis = &machine.axes[i / 2];
        TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter(OFFSETS[i])->state);
        double best_mm = parameter(OFFSETS[i])->value / 1000.0;
        for (int side = -1; side <= 1; side += 2) {
            axis->is_held[i % 2] = 1;
            axis->point_mm[OFFSETS[i][0] - 'X'] = best_mm + 0.001 * side;
            TEST_ASSERT_TRUE(residual_um(n) > least_um);
            machine = before;
        }
        (void)residual_um(n);
    }
}

void test_what_is_held_is_not_called_undetermined(void)
{
    int32_t n = play_ac(0.0);
    hold_tilts(1);

    (void)residual_um(n);

    TEST_ASSERT_EQUAL(2, result.blind_count); /* the zeros */
    TEST_ASSERT_EQUAL(11 - 4, result.rank);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, parameter("BOA")->uncertainty);
}

/* The tilt of C about X and the zero of A are one and the same: the held one gives way. */
void test_a_free_zero_takes_the_tilt_that_is_held(void)
{
    int32_t n = play_ac(50.0 * ARCSEC);
    TEST_ASSERT_TRUE(residual_um(n) < 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 50.0, parameter("AOC")->value);
    machine.axes[0].zero_is_free = 1;
    machine.axes[1].is_held[2] = 1; /* AOC */

    TEST_ASSERT_TRUE(residual_um(n) < 1e-3);

    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("AOA")->state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 50.0, parameter("AOA")->value);
    TEST_ASSERT_EQUAL(KINEMATICS_DETERMINED, parameter("BOC")->state);
    TEST_ASSERT_EQUAL(KINEMATICS_HELD, parameter("AOC")->state);
    TEST_ASSERT_EQUAL(1, result.blind_count); /* COC */
}

/* B of a head turns the tool, the pivot 200 mm above the tip. Every other measurement is 0.1 mm too
 * far along the tool. */
static int32_t play_head(void)
{
    set_axis(0, 'B', 1);
    machine.axes[0].point_mm[2] = 200.0;
    machine.tool_is_known = 1;
    for (int i = 0; i < 13; i++) {
        double *at = points[i].position_mm;
        double  tool[3] = {0.0, 0.0, 200.0};
        double  off[3] = {0.0, 0.0, i % 2 == 0 ? 0.1 : 0.0};
        points[i].angle_deg[0] = 15.0 * i - 90.0;
        turn(&tool[2], &tool[0], points[i].angle_deg[0] * RAD_PER_DEG);
        turn(&off[2], &off[0], points[i].angle_deg[0] * RAD_PER_DEG);
        at[0] = 10.0 + tool[0] + off[0];
        at[1] = 11.0;
        at[2] = 12.0 + tool[2] - 200.0 + off[2];
    }
    return 13;
}

void test_a_coordinate_along_the_tool_counts_as_it_scatters(void)
{
    int32_t n = play_head();
    TEST_ASSERT_TRUE(residual_um(n) > 100.0);

    machine.axial_scatter = 1e3;
    TEST_ASSERT_TRUE(residual_um(n) < 1.0);
}

void test_without_a_head_the_tool_stands_along_z(void)
{
    int32_t n = play_ac(0.0);
    for (int32_t i = 0; i < n; i += 2) {
        points[i].position_mm[2] += 0.1;
    }
    TEST_ASSERT_TRUE(residual_um(n) > 100.0);

    machine.axial_scatter = 1e3;
    TEST_ASSERT_TRUE(residual_um(n) < 1.0);
    machine.axial_scatter = 1.0;
    double alike_um = residual_um(n);
    machine.axial_scatter = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(alike_um, residual_um(n));
}

void test_a_scatter_that_is_none_is_refused(void)
{
    static const double WRONG[] = {-1.0, NAN, INFINITY};
    int32_t             n = play_ac(0.0);
    for (int i = 0; i < 3; i++) {
        machine.axial_scatter = WRONG[i];
        TEST_ASSERT_EQUAL(KINEMATICS_ERR_MACHINE, kinematics_fit(&machine, points, n, &result));
    }
}
