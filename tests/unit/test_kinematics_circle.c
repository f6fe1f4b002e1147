/* One axis in closed form: centre, radius, tilt and what is known of them. */
/* LINK: firmware/comp/kinematics_circle.c firmware/comp/kinematics_coverage.c */
#include <math.h>

#include "comp/kinematics_circle.h"
#include "unity.h"

#define RAD_PER_DEG 0.017453292519943295

static const double        Z[3] = {0.0, 0.0, 1.0};
static kinematics_point_t  points[12];
static kinematics_circle_t circle;

void setUp(void)
{
}

void tearDown(void)
{
}

/* On a circle of 50 mm about (10, -20) at height 7, for the axis of index 1. */
static void turn_about_z(int32_t n, double first_deg, double step_deg)
{
    for (int32_t i = 0; i < n; i++) {
        double angle_deg = first_deg + step_deg * (double)i;
        points[i].angle_deg[1] = angle_deg;
        points[i].position_mm[0] = 10.0 + 50.0 * cos((angle_deg + 30.0) * RAD_PER_DEG);
        points[i].position_mm[1] = -20.0 + 50.0 * sin((angle_deg + 30.0) * RAD_PER_DEG);
        points[i].position_mm[2] = 7.0;
    }
}

void test_a_true_circle_comes_back(void)
{
    turn_about_z(4, -90.0, 60.0);

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_circle_fit(Z, 1, points, 4, &circle));

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, circle.centre_mm[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -20.0, circle.centre_mm[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 7.0, circle.centre_mm[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 50.0, circle.radius_mm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, circle.scatter_mm);
}

void test_two_positions_tell_the_centre_but_no_tilt(void)
{
    turn_about_z(2, 0.0, 90.0);

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_circle_fit(Z, 1, points, 2, &circle));

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, circle.centre_mm[0]);
    TEST_ASSERT_EQUAL(0, circle.direction_is_known);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1.0, circle.direction[2]);
}

void test_a_tilt_shows_along_the_axis(void)
{
    const double b_rad = 1e-3; /* about Y: the axis leans to +X, so +X lies deeper */
    turn_about_z(6, 0.0, 60.0);
    for (int i = 0; i < 6; i++) {
        points[i].position_mm[2] -= b_rad * (points[i].position_mm[0] - 10.0);
    }

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_circle_fit(Z, 1, points, 6, &circle));

    TEST_ASSERT_EQUAL(1, circle.direction_is_known);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, b_rad, circle.direction[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, circle.direction[1]);
}

void test_a_negative_direction_turns_the_other_way(void)
{
    const double down[3] = {0.0, 0.0, -1.0};
    turn_about_z(4, 0.0, 50.0);
    for (int i = 0; i < 4; i++) {
        points[i].angle_deg[1] = -points[i].angle_deg[1];
    }

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_circle_fit(down, 1, points, 4, &circle));

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 50.0, circle.radius_mm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, circle.centre_mm[0]);
}

/* One residual pattern by hand: ±e on the radius of 0, 90, 180, 270° leaves c and r as they are. */
void test_uncertainty_follows_from_the_scatter(void)
{
    const double e = 0.01;
    turn_about_z(4, 0.0, 90.0);
    for (int i = 0; i < 4; i++) {
        double sign = i % 2 == 0 ? 1.0 : -1.0;
        double angle_rad = (90.0 * i + 30.0) * RAD_PER_DEG;
        points[i].position_mm[0] += sign * e * cos(angle_rad);
        points[i].position_mm[1] += sign * e * sin(angle_rad);
    }

    TEST_ASSERT_EQUAL(KINEMATICS_OK, kinematics_circle_fit(Z, 1, points, 4, &circle));

    double scatter_mm = e; /* Σ = 4e² over 2·4 − 4 degrees of freedom */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, circle.centre_mm[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 50.0, circle.radius_mm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, scatter_mm, circle.scatter_mm);
    /* N/(N² − 0) = 1/4; t for four degrees of freedom is 6.620 at 99.73 %. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, scatter_mm / 2.0 * 6.620 / 3.0, circle.uncertainty_mm);
}

void test_angles_that_do_not_differ_are_too_few(void)
{
    turn_about_z(3, 45.0, 0.0);

    TEST_ASSERT_EQUAL(KINEMATICS_ERR_TOO_FEW, kinematics_circle_fit(Z, 1, points, 3, &circle));
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_TOO_FEW, kinematics_circle_fit(Z, 1, points, 1, &circle));
}

void test_what_is_not_finite_is_refused(void)
{
    turn_about_z(4, 0.0, 90.0);
    points[2].position_mm[1] = NAN;
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_POINT, kinematics_circle_fit(Z, 1, points, 4, &circle));

    turn_about_z(4, 0.0, 90.0);
    points[3].angle_deg[1] = INFINITY;
    TEST_ASSERT_EQUAL(KINEMATICS_ERR_POINT, kinematics_circle_fit(Z, 1, points, 4, &circle));
}
