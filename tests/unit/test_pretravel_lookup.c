/* The controller's lookup against the exact map, at its seams, and at the ends of its numbers. */
/* LINK: firmware/comp/pretravel_grid.c firmware/comp/pretravel_lookup.c */
/* LINK: firmware/comp/pretravel_map.c tests/support/dice.c */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "comp/pretravel_grid.h"
#include "dice.h"
#include "unity.h"

#define DEG        (3.14159265358979323846 / 180.0)
#define DIRECTIONS 109u
#define VERTICES   2113u /* of M = 32 */
#define GUARD      64u   /* before and behind the table */
#define TAU_MS     12.68
#define TOP        (51.0 + 20.0)
#define UNIT       (TOP / (double)PRETRAVEL_VERTEX_MAX)

static pretravel_cell_t   cells[DIRECTIONS];
static double             speed_mm_min[DIRECTIONS];
static uint8_t            room[GUARD + VERTICES + GUARD];
static pretravel_lookup_t lookup;

/* β 0, 30 and 60 with 36 azimuths, and the pole; three lobes that die out towards it. */
void setUp(void)
{
    for (uint32_t i = 0; i < DIRECTIONS; i++) {
        double beta_deg = i < 108u ? 30.0 * (double)(i / 36u) : 90.0;
        double alpha_deg = i < 108u ? 10.0 * (double)(i % 36u) : 0.0;
        cells[i] = (pretravel_cell_t){.alpha_deg = alpha_deg, .beta_deg = beta_deg};
        speed_mm_min[i] = 51.0 + 20.0 * cos(3.0 * alpha_deg * DEG) * cos(beta_deg * DEG);
    }
}

void tearDown(void)
{
}

static int build(uint8_t divisions)
{
    uint8_t *vertices = room + GUARD;
    memset(room, 0, sizeof room);
    lookup.pole = vertices + pretravel_grid_size(divisions) / 2u;
    lookup.divisions = divisions;
    return pretravel_grid_build(cells, speed_mm_min, DIRECTIONS, divisions, UNIT, vertices);
}

static double found_mm_min(int16_t dx, int16_t dy, int16_t dz)
{
    return UNIT / (double)PRETRAVEL_LOOKUP_PARTS * (double)pretravel_lookup(&lookup, dx, dy, dz);
}

static double exact_mm_min(int16_t dx, int16_t dy, int16_t dz)
{
    double alpha_deg = atan2((double)dy, (double)dx) / DEG;
    double beta_deg = atan2((double)dz, hypot((double)dx, (double)dy)) / DEG;
    return pretravel_map_at(cells, speed_mm_min, DIRECTIONS, alpha_deg, beta_deg);
}

/* The greatest error over directions every degree, as pretravel. */
static double worst_um(uint8_t divisions)
{
    double worst = 0.0;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(divisions));
    for (int beta = 0; beta <= 90; beta++) {
        for (int alpha = 0; alpha < 360; alpha++) {
            double  across = 32767.0 * cos(beta * DEG);
            int16_t dx = (int16_t)lround(across * cos(alpha * DEG));
            int16_t dy = (int16_t)lround(across * sin(alpha * DEG));
            int16_t dz = (int16_t)lround(32767.0 * sin(beta * DEG));
            double  off = found_mm_min(dx, dy, dz) - exact_mm_min(dx, dy, dz);
            worst = fmax(worst, fabs(off) * TAU_MS / 60.0);
        }
    }
    return worst;
}

/* In percent of V_r; these lobes are round, and 20 mm/min of them are a V_r of 8.45 µm. */
void test_the_error_against_the_map_shrinks_with_the_divisions(void)
{
    double vr_um = 40.0 * TAU_MS / 60.0;

    TEST_ASSERT_TRUE(100.0 * worst_um(8u) / vr_um < 9.0);
    TEST_ASSERT_TRUE(100.0 * worst_um(16u) / vr_um < 4.0);
    TEST_ASSERT_TRUE(100.0 * worst_um(32u) / vr_um < 2.0);
}

void test_no_speed_of_a_table_leaves_the_range_of_the_map(void)
{
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(8u));
    for (uint32_t i = 0; i < pretravel_grid_size(8u); i++) {
        TEST_ASSERT_TRUE(room[GUARD + i] * UNIT >= 31.0 - 0.5 * UNIT);
        TEST_ASSERT_TRUE(room[GUARD + i] * UNIT <= 71.0 + 0.5 * UNIT);
    }
}

void test_at_the_axes_and_diagonals_vertices_are_found_as_they_are(void)
{
    const int16_t signs[] = {-1, 0, 1};
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(16u));
    for (uint32_t i = 0; i < 18u; i++) {
        int16_t dx = (int16_t)(8000 * signs[i % 3u]);
        int16_t dy = (int16_t)(8000 * signs[i / 3u % 3u]);
        int16_t dz = (int16_t)(8000 * (int)(i / 9u));
        if (dx != 0 || dy != 0 || dz != 0) {
            /* what bends near a vertex moves it a little */
            TEST_ASSERT_DOUBLE_WITHIN(0.03 * 40.0, exact_mm_min(dx, dy, dz),
                                      found_mm_min(dx, dy, dz));
        }
    }
}

void test_the_length_of_the_vector_does_not_matter(void)
{
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(16u));
    uint16_t speed = pretravel_lookup(&lookup, 3, -5, 2);
    for (int16_t factor = 2; factor < 1600; factor = (int16_t)(2 * factor)) {
        int16_t dx = (int16_t)(3 * factor);
        int16_t dy = (int16_t)(-5 * factor);
        int16_t dz = (int16_t)(2 * factor);
        TEST_ASSERT_EQUAL_UINT16(speed, pretravel_lookup(&lookup, dx, dy, dz));
    }
}

/* Two steps of 1/32767 to either side of 0°, of 90° and so on, and of the pole. */
void test_there_is_no_step_at_0_degrees_nor_at_the_pole(void)
{
    const double step = 0.1;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(16u));
    for (int16_t dz = 0; dz < 32000; dz = (int16_t)(dz + 1000)) {
        double here = found_mm_min(20000, 2, dz);
        TEST_ASSERT_DOUBLE_WITHIN(step, here, found_mm_min(20000, -2, dz));
        here = found_mm_min(2, 20000, dz);
        TEST_ASSERT_DOUBLE_WITHIN(step, here, found_mm_min(-2, 20000, dz));
        here = found_mm_min(-20000, 2, dz);
        TEST_ASSERT_DOUBLE_WITHIN(step, here, found_mm_min(-20000, -2, dz));
    }
    double pole = found_mm_min(0, 0, 32767);
    TEST_ASSERT_DOUBLE_WITHIN(step, pole, found_mm_min(2, 0, 32767));
    TEST_ASSERT_DOUBLE_WITHIN(step, pole, found_mm_min(-2, 2, 32767));
    TEST_ASSERT_DOUBLE_WITHIN(step, pole, found_mm_min(0, -2, 32767));
}

/* The table just fits its memory, which the sanitizers watch; all of it is 200. */
static void assert_inside(uint8_t divisions, uint32_t vectors)
{
    uint32_t size = pretravel_grid_size(divisions);
    uint8_t *vertices = malloc(size);
    dice_t   dice = dice_seed(divisions);
    TEST_ASSERT_NOT_NULL(vertices);
    memset(vertices, 200, size);
    lookup = (pretravel_lookup_t){vertices + size / 2u, divisions};
    for (uint32_t i = 0; i < vectors; i++) {
        int     shift = (int)dice_below(&dice, 16u);
        int16_t dx = (int16_t)((int16_t)dice_bits(&dice) >> shift);
        int16_t dy = (int16_t)((int16_t)dice_bits(&dice) >> shift);
        int16_t dz = (int16_t)((dice_bits(&dice) & 0x7FFFu) >> (i % 16u));
        if (dx != 0 || dy != 0 || dz != 0) {
            TEST_ASSERT_EQUAL_UINT16(200u * 128u, pretravel_lookup(&lookup, dx, dy, dz));
        }
    }
    free(vertices);
}

void test_no_direction_reads_outside_of_the_table(void)
{
    for (int divisions = 2; divisions <= PRETRAVEL_DIVISIONS_MAX; divisions *= 2) {
        assert_inside((uint8_t)divisions, 100000u);
    }
}

/* Every vertex is a direction, those on the rim as well: its speed comes out as it is. */
static void assert_vertices_found(int m)
{
    uint32_t size = pretravel_grid_size((uint8_t)m);
    uint8_t *vertices = malloc(size);
    uint32_t at = 0u;
    TEST_ASSERT_NOT_NULL(vertices);
    lookup = (pretravel_lookup_t){vertices + size / 2u, (uint8_t)m};
    for (uint32_t i = 0; i < size; i++) {
        vertices[i] = (uint8_t)(1u + i % 251u);
    }
    for (int j = -m; j <= m; j++) {
        for (int i = abs(j) - m; i <= m - abs(j); i++, at++) {
            int      dz = m - abs(i) - abs(j);
            uint16_t found = pretravel_lookup(&lookup, (int16_t)i, (int16_t)j, (int16_t)dz);
            bool     is_tip = abs(i) == m || abs(j) == m; /* 127/128 of the way to it */
            if (!is_tip) {
                TEST_ASSERT_EQUAL_UINT16(128u * vertices[at], found);
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT32(size, at);
    free(vertices);
}

void test_every_vertex_is_found_as_it_is(void)
{
    for (int m = 2; m <= PRETRAVEL_DIVISIONS_MAX; m *= 2) {
        assert_vertices_found(m);
    }
}

void test_the_longest_vectors_are_looked_up_like_shorter_ones(void)
{
    const int16_t ends[] = {INT16_MIN, -INT16_MAX, INT16_MAX};
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(16u));
    for (uint32_t i = 0; i < 9u; i++) {
        int16_t dx = ends[i % 3u];
        int16_t dy = ends[i / 3u];
        double  found = found_mm_min(dx, dy, INT16_MAX);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, found_mm_min((int16_t)(dx / 4), (int16_t)(dy / 4), 8191),
                                  found);
    }
}

void test_no_direction_and_those_below_the_equator_have_no_speed(void)
{
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(16u));

    TEST_ASSERT_EQUAL_UINT16(PRETRAVEL_NO_SPEED, pretravel_lookup(&lookup, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(PRETRAVEL_NO_SPEED, pretravel_lookup(&lookup, 1000, 0, -1));
    TEST_ASSERT_EQUAL_UINT16(PRETRAVEL_NO_SPEED, pretravel_lookup(&lookup, 0, 0, INT16_MIN));
    TEST_ASSERT_TRUE(pretravel_lookup(&lookup, 1000, 0, 0) > 0u);
    TEST_ASSERT_TRUE(pretravel_lookup(&lookup, 0, 0, 1) > 0u);
}

void test_a_table_has_as_many_vertices_as_it_says(void)
{
    TEST_ASSERT_EQUAL_UINT32(13u, pretravel_grid_size(2u));
    TEST_ASSERT_EQUAL_UINT32(145u, pretravel_grid_size(8u));
    TEST_ASSERT_EQUAL_UINT32(VERTICES, pretravel_grid_size(PRETRAVEL_DIVISIONS_MAX));
    for (uint8_t divisions = 2u; divisions <= 32u; divisions = (uint8_t)(2u * divisions)) {
        uint32_t size = pretravel_grid_size(divisions);
        TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(divisions));
        TEST_ASSERT_EQUAL_UINT8(0u, room[GUARD - 1u]);
        TEST_ASSERT_TRUE(room[GUARD] != 0u);
        TEST_ASSERT_TRUE(room[GUARD + size - 1u] != 0u);
        TEST_ASSERT_EQUAL_UINT8(0u, room[GUARD + size]);
    }
}

void test_a_table_is_divided_by_powers_of_two_only(void)
{
    const uint8_t bad[] = {0u, 1u, 3u, 12u, 31u, 33u, 64u, 255u};
    for (uint32_t i = 0; i < sizeof bad; i++) {
        TEST_ASSERT_EQUAL(
            PRETRAVEL_ERR_DIVISIONS,
            pretravel_grid_build(cells, speed_mm_min, DIRECTIONS, bad[i], UNIT, room));
    }
}

void test_a_speed_that_does_not_fit_is_refused(void)
{
    const double bad[] = {0.0, -1.0, 0.49 * UNIT, 255.51 * UNIT, 1e30, (double)NAN};
    for (uint32_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        speed_mm_min[108] = bad[i];
        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_SCALE, build(8u));
    }
    speed_mm_min[108] = 0.51 * UNIT;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(8u));
    speed_mm_min[108] = 255.49 * UNIT;
    TEST_ASSERT_EQUAL(PRETRAVEL_OK, build(8u));
}

void test_the_unit_has_to_be_above_nought(void)
{
    const double bad[] = {0.0, -0.1, (double)NAN};
    for (uint32_t i = 0; i < 3u; i++) {
        TEST_ASSERT_EQUAL(PRETRAVEL_ERR_LIMIT,
                          pretravel_grid_build(cells, speed_mm_min, DIRECTIONS, 8u, bad[i], room));
    }
}
