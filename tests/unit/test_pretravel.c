/* Delay from speeds, speed table with every limit, iteration, time increase. */
/* LINK: firmware/comp/pretravel.c firmware/comp/pretravel_error.c */
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "comp/pretravel.h"
#include "unity.h"

#define N         36u
#define DEG       (3.14159265358979323846 / 180.0)
#define TAU_MS    12.68
#define SPEED     50.0
#define UNTOUCHED (-7.0)

static pretravel_plan_t   plan;
static pretravel_result_t result;
static double             radius_um[N];
static double             speed_mm_min[N];
static double             new_speed_mm_min[N];

void setUp(void)
{
    plan = (pretravel_plan_t){
        .tau_ms = TAU_MS,
        .target = PRETRAVEL_TARGET_MEAN,
        .speed_max_mm_min = INFINITY,
        .overtravel_speed_mm_min = INFINITY,
        .accel_mm_s2 = INFINITY,
        .approach_mm = INFINITY,
    };
    for (uint32_t i = 0; i < N; i++) {
        radius_um[i] = 20.0 + 4.3 * cos(3.0 * 10.0 * (double)i * DEG);
        speed_mm_min[i] = SPEED;
        new_speed_mm_min[i] = UNTOUCHED;
    }
}

void tearDown(void)
{
}

static int compensate(void)
{
    return pretravel_speed_table(radius_um, speed_mm_min, N, &plan, new_speed_mm_min, &result);
}

static void assert_refused_at(int code, uint32_t where)
{
    TEST_ASSERT_EQUAL(code, compensate());
    TEST_ASSERT_EQUAL_UINT32(where, result.where);
    for (uint32_t i = 0; i < N; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(UNTOUCHED, new_speed_mm_min[i]);
    }
}

/* 60 mm/min are 1 µm/ms. */
void test_pretravel_is_the_transducers_and_the_way_during_the_delay(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 7.5, pretravel_um(5.0, 60.0, 2.5));
}

void test_a_ring_gets_wider_and_a_sphere_smaller_by_pretravel(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(12.0, pretravel_from_radius_um(25012.0, 25000.0, PRETRAVEL_INSIDE));
    TEST_ASSERT_EQUAL_DOUBLE(12.0, pretravel_from_radius_um(24988.0, 25000.0, PRETRAVEL_OUTSIDE));
}

void test_the_range_of_radii_is_max_less_min(void)
{
    const double radii[] = {3.0, -1.0, 2.0};

    TEST_ASSERT_EQUAL_DOUBLE(4.0, pretravel_range_um(radii, 3u));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pretravel_range_um(radii, 1u));
}

void test_the_range_is_nan_wherever_a_nan_stands(void)
{
    for (uint32_t i = 0; i < 3u; i++) {
        double radii[] = {3.0, -1.0, 2.0};
        radii[i] = (double)NAN;

        TEST_ASSERT_DOUBLE_IS_NAN(pretravel_range_um(radii, 3u));
    }
}

/* ---- delay --------------------------------------------------------------------------------- */

void test_the_delay_is_the_slope_in_a_ring_and_its_negative_on_a_sphere(void)
{
    const double    speeds[] = {50.0, 100.0, 150.0, 50.0};
    double          ring[4];
    double          sphere[4];
    pretravel_tau_t tau;
    for (uint32_t i = 0; i < 4u; i++) {
        ring[i] = pretravel_um(26000.0, speeds[i], 14.5);
        sphere[i] = -pretravel_um(-12500.0, speeds[i], 14.5);
    }

    TEST_ASSERT_EQUAL(PRETRAVEL_OK,
                      pretravel_estimate_tau(speeds, ring, 4u, PRETRAVEL_INSIDE, &tau));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 14.5, tau.tau_ms);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 26000.0, tau.offset_um);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK,
                      pretravel_estimate_tau(speeds, sphere, 4u, PRETRAVEL_OUTSIDE, &tau));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 14.5, tau.tau_ms);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 12500.0, tau.offset_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, tau.scatter_um);
}

/* By hand: speeds 60, 120, 180, 240, radii 1, 2, 2, 4: slope 0.9/60, residuals 0.1, 0.2, −0.7, 0.4.
 */
void test_the_uncertainty_of_the_delay_is_that_of_the_slope(void)
{
    const double    speeds[] = {60.0, 120.0, 180.0, 240.0};
    const double    radii[] = {1.0, 2.0, 2.0, 4.0};
    pretravel_tau_t tau;

    TEST_ASSERT_EQUAL(PRETRAVEL_OK,
                      pretravel_estimate_tau(speeds, radii, 4u, PRETRAVEL_INSIDE, &tau));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.9, tau.tau_ms);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, tau.offset_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(0.70 / 2.0), tau.scatter_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(0.70 / 2.0 / 5.0), tau.tau_uncertainty_ms);
}

void test_no_delay_comes_of_one_speed_or_too_few_runs(void)
{
    const double    speeds[] = {50.0, 50.0, 50.0};
    const double    more[] = {50.0, 100.0};
    const double    radii[] = {1.0, 1.1, 0.9};
    pretravel_tau_t tau;

    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_ONE_SPEED,
                      pretravel_estimate_tau(speeds, radii, 3u, PRETRAVEL_INSIDE, &tau));
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_FEW_RUNS,
                      pretravel_estimate_tau(more, radii, 2u, PRETRAVEL_INSIDE, &tau));
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_FEW_RUNS,
                      pretravel_estimate_tau(more, radii, 0u, PRETRAVEL_INSIDE, &tau));
}

void test_a_slope_that_is_flat_or_falls_is_no_delay(void)
{
    const double    speeds[] = {50.0, 100.0, 150.0};
    const double    flat[] = {2.0, 2.0, 2.0};
    const double    rising[] = {1.0, 2.0, 3.0};
    pretravel_tau_t tau = {.tau_ms = UNTOUCHED};

    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_TAU,
                      pretravel_estimate_tau(speeds, flat, 3u, PRETRAVEL_INSIDE, &tau));
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_TAU,
                      pretravel_estimate_tau(speeds, rising, 3u, PRETRAVEL_OUTSIDE, &tau));
    TEST_ASSERT_EQUAL_DOUBLE(UNTOUCHED, tau.tau_ms);
}

void test_runs_with_a_nan_or_a_speed_of_nought_are_refused(void)
{
    pretravel_tau_t tau;
    for (uint32_t i = 0; i < 3u; i++) {
        double speeds[] = {50.0, 100.0, 150.0};
        double radii[] = {1.0, 2.0, 3.0};
        radii[i] = (double)NAN;
        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_NOT_FINITE,
                          pretravel_estimate_tau(speeds, radii, 3u, PRETRAVEL_INSIDE, &tau));
        radii[i] = 1.0;
        speeds[i] = (double)INFINITY;
        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_NOT_FINITE,
                          pretravel_estimate_tau(speeds, radii, 3u, PRETRAVEL_INSIDE, &tau));
        speeds[i] = 0.0;
        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_SPEED,
                          pretravel_estimate_tau(speeds, radii, 3u, PRETRAVEL_INSIDE, &tau));
    }
}

/* ---- speed table --------------------------------------------------------------------------- */

void test_at_the_new_speeds_every_direction_has_the_target(void)
{
    double predicted_um[N];

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
    pretravel_predict_um(radius_um, speed_mm_min, new_speed_mm_min, N, TAU_MS, predicted_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 20.0, result.target_um);
    for (uint32_t i = 0; i < N; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 20.0, predicted_um[i]);
    }
}

/* The measure: (v_max − v_min)·τ = V_r to 0.1 %. */
void test_the_range_of_speeds_makes_up_for_the_range_of_radii(void)
{
    double vr_um = pretravel_range_um(radius_um, N);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
    double made_up_um = pretravel_um(0.0, pretravel_range_um(new_speed_mm_min, N), TAU_MS);
    TEST_ASSERT_DOUBLE_WITHIN(0.001 * vr_um, vr_um, made_up_um);
}

void test_the_target_max_slows_nothing_down_and_min_speeds_nothing_up(void)
{
    plan.target = PRETRAVEL_TARGET_MAX;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 24.3, result.target_um);
    for (uint32_t i = 0; i < N; i++) {
        TEST_ASSERT_TRUE(new_speed_mm_min[i] >= SPEED);
    }

    plan.target = PRETRAVEL_TARGET_MIN;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 15.7, result.target_um);
    for (uint32_t i = 0; i < N; i++) {
        TEST_ASSERT_TRUE(new_speed_mm_min[i] <= SPEED);
    }
}

void test_a_given_target_is_taken_as_it_is(void)
{
    plan.target = PRETRAVEL_TARGET_GIVEN;
    plan.target_um = radius_um[5];

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
    TEST_ASSERT_EQUAL_DOUBLE(radius_um[5], result.target_um);
    TEST_ASSERT_EQUAL_DOUBLE(SPEED, new_speed_mm_min[5]);
}

void test_a_given_target_has_to_be_a_number(void)
{
    plan.target = PRETRAVEL_TARGET_GIVEN;
    plan.target_um = (double)NAN;

    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_NOT_FINITE, compensate());
}

/*
 * What is measured is not what is planned with: the true delay is 20 % longer than believed. The
 * error of a direction shrinks by |1 − 1.2| each time, in place, its own speed being v0.
 */
void test_iterating_with_the_last_speeds_makes_up_for_a_wrong_delay(void)
{
    double transducer_um[N];
    for (uint32_t i = 0; i < N; i++) {
        transducer_um[i] = radius_um[i];
    }
    double before_um = pretravel_range_um(transducer_um, N);
    for (int pass = 0; pass < 3; pass++) {
        for (uint32_t i = 0; i < N; i++) {
            radius_um[i] = pretravel_um(transducer_um[i], speed_mm_min[i], 1.2 * TAU_MS);
        }
        double now_um = pretravel_range_um(radius_um, N);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, before_um * pow(0.2, pass), now_um);
        TEST_ASSERT_EQUAL(PRETRAVEL_OK, pretravel_speed_table(radius_um, speed_mm_min, N, &plan,
                                                              speed_mm_min, &result));
    }
}

void test_a_delay_that_is_not_above_nought_is_refused(void)
{
    const double bad[] = {0.0, -0.0, -12.68};
    for (uint32_t i = 0; i < 3u; i++) {
        plan.tau_ms = bad[i];
        assert_refused_at(PRETRAVEL_ERR_TAU, 0u);
    }
    plan.tau_ms = (double)NAN;
    assert_refused_at(PRETRAVEL_ERR_NOT_FINITE, 0u);
    plan.tau_ms = (double)INFINITY;
    assert_refused_at(PRETRAVEL_ERR_NOT_FINITE, 0u);
}

void test_a_map_without_directions_is_refused(void)
{
    TEST_ASSERT_EQUAL(
        PRETRAVEL_ERR_FEW_DIRECTIONS,
        pretravel_speed_table(radius_um, speed_mm_min, 0u, &plan, new_speed_mm_min, &result));
}

void test_what_is_not_a_number_is_refused_and_shown(void)
{
    radius_um[7] = (double)NAN;
    assert_refused_at(PRETRAVEL_ERR_NOT_FINITE, 7u);
    radius_um[7] = 20.0;
    speed_mm_min[N - 1u] = (double)INFINITY;
    assert_refused_at(PRETRAVEL_ERR_NOT_FINITE, N - 1u);
}

void test_a_speed_to_begin_with_has_to_be_above_nought(void)
{
    speed_mm_min[3] = 0.0;
    assert_refused_at(PRETRAVEL_ERR_SPEED, 3u);
}

/* Direction 0 lies highest: −4.3 µm are −20.35 mm/min. */
void test_a_speed_of_nought_or_less_is_too_slow(void)
{
    double least = 4.3 * 60.0 / TAU_MS;
    for (uint32_t i = 0; i < N; i++) {
        speed_mm_min[i] = least * (1.0 - 1e-9);
    }
    assert_refused_at(PRETRAVEL_ERR_TOO_SLOW, 0u);
    for (uint32_t i = 0; i < N; i++) {
        speed_mm_min[i] = least * (1.0 + 1e-9);
    }
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
}

/* Direction 6 lies lowest and becomes fastest. */
static double fastest(void)
{
    return SPEED + 4.3 * 60.0 / TAU_MS;
}

void test_a_speed_above_the_maximum_is_too_fast(void)
{
    plan.speed_max_mm_min = fastest() * (1.0 - 1e-9);
    assert_refused_at(PRETRAVEL_ERR_TOO_FAST, 6u);
    plan.speed_max_mm_min = fastest() * (1.0 + 1e-9);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
}

void test_a_speed_above_that_of_the_allowed_overtravel_is_refused(void)
{
    plan.overtravel_speed_mm_min = fastest() * (1.0 - 1e-9);
    assert_refused_at(PRETRAVEL_ERR_OVERTRAVEL, 6u);
    plan.overtravel_speed_mm_min = fastest() * (1.0 + 1e-9);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
}

void test_the_ramp_has_to_be_shorter_than_the_approach(void)
{
    double speed_mm_s = fastest() / 60.0;
    plan.accel_mm_s2 = 2.0;
    plan.approach_mm = speed_mm_s * speed_mm_s / (2.0 * 2.0) * (1.0 - 1e-9);
    assert_refused_at(PRETRAVEL_ERR_RAMP, 6u);
    plan.approach_mm *= 1.0 + 2e-9;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, compensate());
}

void test_a_limit_has_to_be_above_nought(void)
{
    double *limits[] = {&plan.speed_max_mm_min, &plan.overtravel_speed_mm_min, &plan.accel_mm_s2,
                        &plan.approach_mm};
    for (uint32_t i = 0; i < 4u; i++) {
        double before = *limits[i];
        *limits[i] = 0.0;
        assert_refused_at(PRETRAVEL_ERR_LIMIT, 0u);
        *limits[i] = (double)NAN;
        assert_refused_at(PRETRAVEL_ERR_LIMIT, 0u);
        *limits[i] = before;
    }
}

/* ---- time ---------------------------------------------------------------------------------- */

void test_the_same_speeds_take_no_longer(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0, pretravel_time_increase(speed_mm_min, speed_mm_min, N));
}

/* By hand: half at 50, half at 150 in place of 100: (1/50 + 1/150)/2·100 = 4/3. */
void test_slow_directions_cost_more_than_fast_ones_save(void)
{
    const double before[] = {100.0, 100.0};
    const double after[] = {50.0, 150.0};

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0 / 3.0, pretravel_time_increase(before, after, 2u));
}

/* 4 mm at 50, 100 and 200 mm/min take 4.8, 2.4 and 1.2 s. */
void test_the_time_of_approaches_is_way_over_speed(void)
{
    const double feeds_mm_min[] = {50.0, 100.0, 200.0};

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4.8, pretravel_time_s(feeds_mm_min, 1u, 4.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 8.4, pretravel_time_s(feeds_mm_min, 3u, 4.0));
}

/* ---- errors -------------------------------------------------------------------------------- */

void test_every_code_has_a_sentence_of_its_own(void)
{
    for (int a = PRETRAVEL_OK; a >= PRETRAVEL_ERR_DIVISIONS; a--) {
        TEST_ASSERT_NOT_NULL(pretravel_error(a));
        for (int b = PRETRAVEL_OK; b > a; b--) {
            TEST_ASSERT_TRUE(strcmp(pretravel_error(a), pretravel_error(b)) != 0);
        }
    }
}

void test_a_code_that_there_is_not_is_said_to_be_none(void)
{
    TEST_ASSERT_EQUAL_STRING("no such code", pretravel_error(1));
    TEST_ASSERT_EQUAL_STRING("no such code", pretravel_error(PRETRAVEL_ERR_DIVISIONS - 1));
}
