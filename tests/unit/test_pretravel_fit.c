/* Best-fit centre and trigger radii. */
/* LINK: firmware/comp/pretravel_fit.c */
#include <math.h>

#include "comp/pretravel_fit.h"
#include "unity.h"

#define N   109u
#define DEG (3.14159265358979323846 / 180.0)

static pretravel_point_t points[N];
static pretravel_fit_t   fit;

void setUp(void)
{
    fit = (pretravel_fit_t){.radius_um = -7.0};
}

void tearDown(void)
{
}

static pretravel_point_t point_at(double alpha_deg, double beta_deg, double radius_um)
{
    double across_um = radius_um * cos(beta_deg * DEG);
    return (pretravel_point_t){
        .x_um = 1234.5 + across_um * cos(alpha_deg * DEG),
        .y_um = -777.0 + across_um * sin(alpha_deg * DEG),
        .z_um = 31.25 + radius_um * sin(beta_deg * DEG),
    };
}

/* β 0, 30 and 60 with 36 azimuths, and the pole. */
static void fill_half_sphere(double radius_um, double lobe_um)
{
    for (uint32_t i = 0; i < N; i++) {
        double beta_deg = i < 108u ? 30.0 * (double)(i / 36u) : 90.0;
        double alpha_deg = 10.0 * (double)(i % 36u);
        double lobe = lobe_um * cos(3.0 * alpha_deg * DEG) * cos(beta_deg * DEG);
        points[i] = point_at(alpha_deg, beta_deg, radius_um + lobe);
    }
}

void test_the_centre_of_a_circle_is_found_from_an_arc(void)
{
    for (uint32_t i = 0; i < 10u; i++) {
        points[i] = point_at(100.0 + 7.0 * (double)i, 0.0, 26000.0);
        points[i].z_um = (double)NAN; /* not looked at */
    }

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, pretravel_fit(points, 10u, PRETRAVEL_CIRCLE, &fit));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1234.5, fit.x_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -777.0, fit.y_um);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, fit.z_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 26000.0, fit.radius_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, fit.scatter_um);
}

void test_the_centre_of_a_sphere_is_found_from_its_upper_half(void)
{
    fill_half_sphere(12500.0, 0.0);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, pretravel_fit(points, N, PRETRAVEL_SPHERE, &fit));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1234.5, fit.x_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -777.0, fit.y_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 31.25, fit.z_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 12500.0, fit.radius_um);
}

void test_as_many_points_as_unknowns_lie_on_the_circle_and_the_sphere(void)
{
    const double alpha_deg[] = {0.0, 130.0, 200.0, 300.0};
    for (uint32_t i = 0; i < 4u; i++) {
        points[i] = point_at(alpha_deg[i], 20.0 * (double)(i % 2u), 500.0);
    }

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, pretravel_fit(points, 3u, PRETRAVEL_CIRCLE, &fit));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, fit.scatter_um);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, pretravel_fit(points, 4u, PRETRAVEL_SPHERE, &fit));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 500.0, fit.radius_um);
}

/* Lobes of threefold symmetry neither move the centre nor, over full rows, change the radius. */
void test_lobes_stay_in_the_trigger_radii(void)
{
    double radius_um[N];
    fill_half_sphere(12500.0, 4.0);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, pretravel_fit(points, N, PRETRAVEL_SPHERE, &fit));
    pretravel_radii_um(points, N, PRETRAVEL_SPHERE, &fit, radius_um);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 12504.0, radius_um[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 12496.0, radius_um[6]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 12500.0, radius_um[N - 1u]);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 12500.0, fit.radius_um);
}

/* At the minimum of Σ(|p − c| − r)² its derivatives vanish: the residuals and their moments. */
void test_the_fit_is_the_least_of_the_squared_distances(void)
{
    double residual = 0.0;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    double radius_um[N];
    for (uint32_t i = 0; i < N; i++) {
        double off_um = (double)((i * 7919u) % 101u) / 10.0;
        points[i] = point_at(3.3 * (double)i, 0.7 * (double)i, 100.0 + off_um);
    }

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, pretravel_fit(points, N, PRETRAVEL_SPHERE, &fit));
    pretravel_radii_um(points, N, PRETRAVEL_SPHERE, &fit, radius_um);
    for (uint32_t i = 0; i < N; i++) {
        double off_um = radius_um[i] - fit.radius_um;
        residual += off_um;
        x += off_um * (points[i].x_um - fit.x_um) / radius_um[i];
        y += off_um * (points[i].y_um - fit.y_um) / radius_um[i];
        z += off_um * (points[i].z_um - fit.z_um) / radius_um[i];
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, residual);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, z);
    TEST_ASSERT_TRUE(fit.scatter_um > 1.0);
}

void test_radii_of_a_circle_do_not_look_at_the_height(void)
{
    double radius_um[1];
    points[0] = (pretravel_point_t){3.0, 4.0, 1000.0};
    fit = (pretravel_fit_t){0};

    pretravel_radii_um(points, 1u, PRETRAVEL_CIRCLE, &fit, radius_um);

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 5.0, radius_um[0]);
}

void test_too_few_points_have_no_centre(void)
{
    fill_half_sphere(100.0, 0.0);

    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_FEW_POINTS, pretravel_fit(points, 2u, PRETRAVEL_CIRCLE, &fit));
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_FEW_POINTS, pretravel_fit(points, 3u, PRETRAVEL_SPHERE, &fit));
    TEST_ASSERT_EQUAL_DOUBLE(-7.0, fit.radius_um);
}

void test_points_that_leave_the_centre_open_are_refused(void)
{
    for (uint32_t i = 0; i < 8u; i++) {
        points[i] = (pretravel_point_t){10.0 * (double)i, 5.0 + 3.0 * (double)i, 0.0};
    }
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_CENTRE, pretravel_fit(points, 8u, PRETRAVEL_CIRCLE, &fit));
    fill_half_sphere(100.0, 0.0); /* the first 36 lie on the equator */
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_CENTRE, pretravel_fit(points, 36u, PRETRAVEL_SPHERE, &fit));
    for (uint32_t i = 0; i < 8u; i++) {
        points[i] = (pretravel_point_t){1.0, 2.0, 3.0};
    }
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_CENTRE, pretravel_fit(points, 8u, PRETRAVEL_SPHERE, &fit));
    TEST_ASSERT_EQUAL_DOUBLE(-7.0, fit.radius_um);
}

void test_a_point_that_is_no_number_is_refused(void)
{
    for (uint32_t i = 0; i < 3u; i++) {
        fill_half_sphere(100.0, 0.0);
        double *coordinates[] = {&points[50].x_um, &points[50].y_um, &points[50].z_um};
        *coordinates[i] = i == 1u ? (double)INFINITY : (double)NAN;

        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_NOT_FINITE,
                          pretravel_fit(points, N, PRETRAVEL_SPHERE, &fit));
    }
}
