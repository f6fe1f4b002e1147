/* Map of radii: repeats, gaps, interpolation, the wrap at 360° and the pole. */
/* LINK: firmware/comp/pretravel_map.c */
#include <math.h>
#include <stdbool.h>

#include "comp/pretravel_map.h"
#include "unity.h"

#define DIRECTIONS 109u
#define RUNS       10u
#define READINGS   (DIRECTIONS * RUNS)

static double           alpha_deg[READINGS];
static double           beta_deg[READINGS];
static double           radius_um[READINGS];
static pretravel_cell_t cells[DIRECTIONS];
static double           values[DIRECTIONS];
static uint32_t         count;
static pretravel_gap_t  gap;

void setUp(void)
{
    count = 0u;
    gap = (pretravel_gap_t){-7.0, -7.0, -7.0};
}

void tearDown(void)
{
}

/* Readings of one direction after the other are added to those there are. */
static void read_row(double beta, double from_deg, double step_deg, uint32_t azimuths)
{
    for (uint32_t i = 0; i < azimuths; i++) {
        alpha_deg[count] = from_deg + step_deg * (double)i;
        beta_deg[count] = beta;
        radius_um[count] = beta + alpha_deg[count];
        count++;
    }
}

/* β 0, 30 and 60 with 36 azimuths, and the pole. */
static void read_half_sphere(void)
{
    read_row(0.0, 0.0, 10.0, 36u);
    read_row(30.0, 0.0, 10.0, 36u);
    read_row(60.0, 0.0, 10.0, 36u);
    read_row(90.0, 0.0, 10.0, 1u);
}

static int build(void)
{
    return pretravel_map_build(alpha_deg, beta_deg, radius_um, count, cells, DIRECTIONS, &count);
}

static int build_and_check(void)
{
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build());
    for (uint32_t i = 0; i < count; i++) {
        values[i] = cells[i].radius_um;
    }
    return pretravel_map_check(cells, count, &gap);
}

static void remove_reading(uint32_t at)
{
    count--;
    for (uint32_t i = at; i < count; i++) {
        alpha_deg[i] = alpha_deg[i + 1u];
        beta_deg[i] = beta_deg[i + 1u];
        radius_um[i] = radius_um[i + 1u];
    }
}

static double at(double alpha, double beta)
{
    return pretravel_map_at(cells, values, count, alpha, beta);
}

/* ---- repeats ------------------------------------------------------------------------------- */

void test_repeats_of_a_direction_become_their_mean_and_scatter(void)
{
    const double repeats_um[] = {9.0, 10.0, 14.0};
    for (uint32_t i = 0; i < 3u; i++) {
        alpha_deg[i] = 30.0;
        beta_deg[i] = 45.0;
        radius_um[i] = repeats_um[i];
    }
    count = 3u;

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build());
    TEST_ASSERT_EQUAL_UINT32(1u, count);
    TEST_ASSERT_EQUAL_UINT32(3u, cells[0].runs);
    TEST_ASSERT_EQUAL_DOUBLE(30.0, cells[0].alpha_deg);
    TEST_ASSERT_EQUAL_DOUBLE(45.0, cells[0].beta_deg);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 11.0, cells[0].radius_um);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(7.0), cells[0].scatter_um);
}

void test_a_single_reading_has_no_scatter(void)
{
    read_row(0.0, 0.0, 0.0, 1u);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build());
    TEST_ASSERT_DOUBLE_IS_NAN(cells[0].scatter_um);
}

/* 1000003 and 1090 share no factor: every reading once, in a wild order. */
void test_the_order_of_the_readings_does_not_matter(void)
{
    for (uint32_t i = 0; i < READINGS; i++) {
        uint32_t direction = (uint32_t)((uint64_t)i * 1000003u % READINGS) / RUNS;
        beta_deg[i] = direction < 108u ? 30.0 * (double)(direction / 36u) : 90.0;
        alpha_deg[i] = 10.0 * (double)(direction % 36u);
        radius_um[i] = (double)direction;
    }
    count = READINGS;

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());
    TEST_ASSERT_EQUAL_UINT32(DIRECTIONS, count);
    for (uint32_t i = 0; i < DIRECTIONS; i++) {
        TEST_ASSERT_EQUAL_UINT32(RUNS, cells[i].runs);
        TEST_ASSERT_EQUAL_DOUBLE((double)i, cells[i].radius_um);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, cells[i].scatter_um);
    }
}

void test_0_and_360_and_a_hair_less_are_one_azimuth(void)
{
    const double same_deg[] = {0.0, 360.0, -360.0, 359.9999, 0.0001, -0.0001};
    for (uint32_t i = 0; i < 6u; i++) {
        alpha_deg[i] = same_deg[i];
        beta_deg[i] = 0.0;
        radius_um[i] = 1.0;
    }
    count = 6u;

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build());
    TEST_ASSERT_EQUAL_UINT32(1u, count);
    TEST_ASSERT_EQUAL_UINT32(6u, cells[0].runs);
}

void test_a_negative_azimuth_counts_back_from_360(void)
{
    read_row(0.0, -90.0, 0.0, 1u);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build());
    TEST_ASSERT_EQUAL_DOUBLE(270.0, cells[0].alpha_deg);
}

void test_at_the_pole_every_azimuth_is_the_same(void)
{
    read_row(90.0, 0.0, 10.0, 36u);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build());
    TEST_ASSERT_EQUAL_UINT32(1u, count);
    TEST_ASSERT_EQUAL_UINT32(36u, cells[0].runs);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, cells[0].alpha_deg);
}

void test_a_reading_that_is_no_number_is_refused_and_shown(void)
{
    double *columns[] = {alpha_deg, beta_deg, radius_um};
    for (uint32_t i = 0; i < 3u; i++) {
        count = 0u;
        read_half_sphere();
        columns[i][70] = i == 1u ? (double)INFINITY : (double)NAN;

        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_NOT_FINITE, build());
        TEST_ASSERT_EQUAL_UINT32(70u, count);
    }
}

void test_an_angle_out_of_range_is_refused_and_shown(void)
{
    const double bad_alpha[] = {360.1, -360.1, 0.0, 0.0};
    const double bad_beta[] = {0.0, 0.0, -0.1, 90.1};
    for (uint32_t i = 0; i < 4u; i++) {
        count = 0u;
        read_half_sphere();
        alpha_deg[3] = bad_alpha[i];
        beta_deg[3] = bad_beta[i];

        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_DIRECTION, build());
        TEST_ASSERT_EQUAL_UINT32(3u, count);
    }
}

void test_more_directions_than_room_are_refused_and_repeats_are_not(void)
{
    read_row(0.0, 0.0, 10.0, 3u);
    read_row(0.0, 0.0, 10.0, 3u);

    uint32_t found = 0u;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK,
                      pretravel_map_build(alpha_deg, beta_deg, radius_um, 6u, cells, 3u, &found));
    TEST_ASSERT_EQUAL_UINT32(3u, found);
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_CAPACITY,
                      pretravel_map_build(alpha_deg, beta_deg, radius_um, 6u, cells, 2u, &found));
    TEST_ASSERT_EQUAL_UINT32(2u, found);
}

/* ---- gaps ---------------------------------------------------------------------------------- */

void test_a_half_sphere_is_complete(void)
{
    read_half_sphere();

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());
    TEST_ASSERT_EQUAL_DOUBLE(-7.0, gap.width_deg);
}

void test_one_row_is_a_map(void)
{
    read_row(45.0, 5.0, 60.0, 6u);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());
}

/* The 25 points of ISO 10360-5: rows of different azimuths, half a step against each other. */
void test_rows_may_differ_in_their_azimuths(void)
{
    read_row(0.0, 0.0, 45.0, 8u);
    read_row(22.5, 22.5, 90.0, 4u);
    read_row(45.0, 0.0, 45.0, 8u);
    read_row(67.5, 22.5, 90.0, 4u);
    read_row(90.0, 0.0, 0.0, 1u);

    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());
    TEST_ASSERT_EQUAL_UINT32(25u, count);
}

void test_every_missing_direction_is_a_gap_where_it_is(void)
{
    for (uint32_t missing = 0; missing < 108u; missing++) {
        count = 0u;
        read_half_sphere();
        double before_deg = fmod(alpha_deg[missing] + 350.0, 360.0);
        double row_deg = beta_deg[missing];
        remove_reading(missing);

        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_GAP, build_and_check());
        TEST_ASSERT_EQUAL_DOUBLE(before_deg, gap.alpha_deg);
        TEST_ASSERT_EQUAL_DOUBLE(row_deg, gap.beta_deg);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 20.0, gap.width_deg);
    }
}

void test_half_a_turn_is_no_map(void)
{
    read_row(0.0, 0.0, 10.0, 19u);

    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_GAP, build_and_check());
    TEST_ASSERT_EQUAL_DOUBLE(180.0, gap.alpha_deg);
    TEST_ASSERT_EQUAL_DOUBLE(180.0, gap.width_deg);
}

void test_a_missing_row_is_a_gap(void)
{
    read_row(0.0, 0.0, 10.0, 36u);
    read_row(60.0, 0.0, 10.0, 36u);
    read_row(80.0, 0.0, 10.0, 36u);

    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_GAP, build_and_check());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, gap.beta_deg);
    TEST_ASSERT_EQUAL_DOUBLE(60.0, gap.width_deg);
}

void test_a_step_of_one_and_a_half_is_no_gap_and_a_longer_one_is(void)
{
    read_row(0.0, 0.0, 30.0, 11u); /* to 300 */
    read_row(0.0, 329.9, 0.0, 1u);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    count = 0u;
    read_row(0.0, 0.0, 30.0, 11u);
    read_row(0.0, 345.1, 0.0, 1u);
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_GAP, build_and_check());
    TEST_ASSERT_EQUAL_DOUBLE(300.0, gap.alpha_deg);
}

void test_too_few_directions_are_no_map(void)
{
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_FEW_DIRECTIONS, pretravel_map_check(cells, 0u, &gap));
    read_row(0.0, 0.0, 72.0, PRETRAVEL_DIRECTIONS_MIN - 1);
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_FEW_DIRECTIONS, build_and_check());

    count = 0u;
    read_row(0.0, 0.0, 45.0, 8u);
    read_row(45.0, 0.0, 180.0, PRETRAVEL_AZIMUTHS_MIN - 1);
    TEST_ASSERT_EQUAL(PRETRAVEL_ERR_FEW_DIRECTIONS, build_and_check());
}

/* ---- interpolation ------------------------------------------------------------------------- */

void test_at_a_measured_direction_the_map_is_what_was_measured(void)
{
    read_half_sphere();
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    for (uint32_t i = 0; i < count; i++) {
        double found = at(cells[i].alpha_deg, cells[i].beta_deg);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, cells[i].radius_um, found);
    }
}

void test_between_directions_the_map_is_linear(void)
{
    read_half_sphere();
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 20.0 + 123.4, at(123.4, 20.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 59.0 + 12.5, at(12.5, 59.0));
}

/* From 350 back to 0 within a step: 350 → 0 µm in these readings. */
void test_the_map_goes_on_across_360(void)
{
    read_half_sphere();
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 175.0, at(355.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, at(355.0, 10.0), at(-5.0, 10.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, at(0.0, 10.0), at(360.0, 10.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, at(0.0, 10.0), at(359.9995, 10.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, at(5.0, 10.0), at(725.0, 10.0));
}

/* No cell at 0: the first azimuth of the row is 5. */
void test_before_the_first_azimuth_the_last_one_counts(void)
{
    read_row(0.0, 5.0, 10.0, 36u);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (355.0 + 5.0) / 2.0, at(0.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.25 * 355.0 + 0.75 * 5.0, at(2.5, 0.0));
}

void test_all_azimuths_meet_at_the_pole(void)
{
    read_half_sphere();
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    for (double alpha = 0.0; alpha < 360.0; alpha += 7.0) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 90.0, at(alpha, 90.0));
    }
}

void test_a_row_short_of_the_pole_closes_in_its_mean(void)
{
    read_row(0.0, 0.0, 10.0, 36u);
    read_row(80.0, 0.0, 10.0, 36u);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 80.0 + 175.0, at(33.0, 90.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 80.0 + (175.0 + 33.0) / 2.0, at(33.0, 85.0));
}

void test_below_the_lowest_row_the_map_is_that_row(void)
{
    read_row(30.0, 0.0, 10.0, 36u);
    read_row(60.0, 0.0, 10.0, 36u);
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build_and_check());

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 30.0 + 44.0, at(44.0, 0.0));
}
