/* Probing a sphere: the way of the tip, and the centre and radius from true points. */
/* LINK: firmware/cycle/sphere_probe.c */
#include <math.h>

#include "cycle/sphere_probe.h"
#include "unity.h"

#define TINY_MM 1e-9
#define CONTACT 15.0

static sphere_probe_config_t config;
static sphere_probe_t        probe;
static double                centre[3];
static double                contact;

void setUp(void)
{
    config = (sphere_probe_config_t){
        .centre_mm = {100.0, -50.0, 30.0},
        .tool_axis = {0.0, 0.0, 1.0},
        .contact_mm = CONTACT,
        .stand_off_mm = 4.0,
        .reference_deg = 0.0,
        .touches = 4,
    };
}

void tearDown(void)
{
}

static double distance(const double *a, const double *b)
{
    return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* How near the segment from a to b comes to the centre of the sphere that is expected. */
static double nearest(const double *a, const double *b)
{
    double along = 0.0;
    double length = 0.0;
    for (int i = 0; i < 3; i++) {
        along += (config.centre_mm[i] - a[i]) * (b[i] - a[i]);
        length += pow(b[i] - a[i], 2);
    }
    double share = length > 0.0 ? fmin(1.0, fmax(0.0, along / length)) : 0.0;
    double point[3];
    for (int i = 0; i < 3; i++) {
        point[i] = a[i] + share * (b[i] - a[i]);
    }
    return distance(point, config.centre_mm);
}

/* The ray from the start meets the sphere, by the quadratic of ray and sphere. */
static void touch_true_sphere(const sphere_probe_step_t *step, const double *true_centre,
                              double radius, double *touched)
{
    double along = 0.0;
    double off = distance(step->target_mm, true_centre);
    for (int i = 0; i < 3; i++) {
        along += (true_centre[i] - step->target_mm[i]) * step->direction[i];
    }
    double root = radius * radius - off * off + along * along;
    TEST_ASSERT_TRUE_MESSAGE(root > 0.0, "the touch passes by the sphere");
    for (int i = 0; i < 3; i++) {
        touched[i] = step->target_mm[i] + (along - sqrt(root)) * step->direction[i];
    }
}

static int measure(const double *true_centre, double radius)
{
    sphere_probe_step_t step;
    int                 touches = 0;

    sphere_probe_start(&probe, &config);
    while (sphere_probe_next(&probe, &step)) {
        if (step.is_touch) {
            double touched[3];
            touch_true_sphere(&step, true_centre, radius, touched);
            sphere_probe_touched(&probe, touched);
            touches++;
        }
    }
    return touches;
}

static void check_found(const double *true_centre, double radius)
{
    measure(true_centre, radius);

    TEST_ASSERT_TRUE(sphere_probe_solve(&probe, centre, &contact));
    TEST_ASSERT_TRUE(distance(true_centre, centre) < TINY_MM);
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, radius, contact);
}

void test_a_sphere_where_it_is_expected_is_found_with_any_number_of_touches(void)
{
    for (uint8_t touches = 3u; touches <= SPHERE_TOUCHES_MAX; touches++) {
        config.touches = touches;
        check_found(config.centre_mm, CONTACT);
        TEST_ASSERT_EQUAL(touches + 1, measure(config.centre_mm, CONTACT));
    }
}

void test_a_sphere_elsewhere_is_found_exactly(void)
{
    for (uint8_t touches = 3u; touches <= SPHERE_TOUCHES_MAX; touches++) {
        for (int i = 0; i < 60; i++) {
            double off = 0.1 * i;
            double there[3] = {100.0 + off * cos(i), -50.0 + off * sin(i), 30.0 + off * cos(2 * i)};
            config.touches = touches;
            config.reference_deg = 6.0 * i;
            check_found(there, CONTACT);
        }
    }
}

void test_a_tilted_probe_finds_it_too(void)
{
    const double axes[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0.6, 0, 0.8}, {-0.48, 0.6, 0.64}};
    double       there[3] = {100.4, -50.3, 29.5};

    for (unsigned i = 0; i < sizeof axes / sizeof *axes; i++) {
        for (int k = 0; k < 3; k++) {
            config.tool_axis[k] = axes[i][k];
        }
        check_found(there, CONTACT);
    }
}

void test_a_sphere_of_another_radius_shows_its_radius(void)
{
    measure(config.centre_mm, CONTACT + 0.2);

    TEST_ASSERT_TRUE(sphere_probe_solve(&probe, centre, &contact));
    TEST_ASSERT_DOUBLE_WITHIN(TINY_MM, CONTACT + 0.2, contact);
}

void test_between_touches_the_tip_keeps_clear_of_the_sphere(void)
{
    sphere_probe_step_t before;
    sphere_probe_step_t step;

    config.touches = 3; /* the longest way round */
    sphere_probe_start(&probe, &config);
    TEST_ASSERT_TRUE(sphere_probe_next(&probe, &before));
    while (sphere_probe_next(&probe, &step)) {
        TEST_ASSERT_TRUE(nearest(before.target_mm, step.target_mm) >
                         CONTACT + config.stand_off_mm - TINY_MM);
        if (step.is_touch) {
            TEST_ASSERT_TRUE(distance(before.target_mm, step.target_mm) < TINY_MM);
            sphere_probe_touched(&probe, step.target_mm);
        }
        before = step;
    }
}

void test_the_reference_angle_turns_the_touches_about_the_tool_axis(void)
{
    sphere_probe_step_t step;
    int                 touch = 0;

    config.reference_deg = 30.0;
    sphere_probe_start(&probe, &config);
    while (sphere_probe_next(&probe, &step)) {
        if (step.is_touch && ++touch == 2) { /* the first on the equator */
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, -cos(M_PI / 6), step.direction[0]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, -sin(M_PI / 6), step.direction[1]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, step.direction[2]);
        }
    }
    TEST_ASSERT_EQUAL(5, touch);
}

/* ---- what is no sphere ---- */

static void hand_on(const double points[5][3])
{
    sphere_probe_start(&probe, &config);
    for (int i = 0; i < 5; i++) {
        double touched[3];
        for (int k = 0; k < 3; k++) {
            touched[k] = config.centre_mm[k] + points[i][k];
        }
        sphere_probe_touched(&probe, touched);
    }
}

static const double ROUND[5][3] = {
    {0, 0, CONTACT}, {CONTACT, 0, 0}, {0, CONTACT, 0}, {-CONTACT, 0, 0}, {0, -CONTACT, 0},
};

void test_points_in_a_row_are_no_sphere(void)
{
    const double row[5][3] = {{0, 0, CONTACT}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};

    hand_on(row);
    TEST_ASSERT_FALSE(sphere_probe_solve(&probe, centre, &contact));
}

void test_a_pole_beside_the_circle_is_no_sphere(void)
{
    double points[5][3];

    for (int i = 0; i < 15; i++) {
        points[i / 3][i % 3] = ROUND[i / 3][i % 3];
    }
    hand_on((const double (*)[3])points);
    TEST_ASSERT_TRUE(sphere_probe_solve(&probe, centre, &contact));

    points[0][0] = CONTACT;
    hand_on((const double (*)[3])points);
    TEST_ASSERT_FALSE(sphere_probe_solve(&probe, centre, &contact));
}

void test_a_nan_anywhere_is_no_sphere(void)
{
    for (int bad = 0; bad < 15; bad++) {
        double points[5][3];
        for (int i = 0; i < 15; i++) {
            points[i / 3][i % 3] = i == bad ? NAN : ROUND[i / 3][i % 3];
        }
        hand_on((const double (*)[3])points);
        TEST_ASSERT_FALSE(sphere_probe_solve(&probe, centre, &contact));
    }
}

void test_a_missing_touch_is_no_sphere(void)
{
    hand_on(ROUND);
    probe.touched--;
    TEST_ASSERT_FALSE(sphere_probe_solve(&probe, centre, &contact));
}
