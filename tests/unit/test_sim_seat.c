/* The mechanics of a probe with a three-contact seat. */
/* LINK: host_sim/seat.c */
#include <math.h>

#include "seat.h"
#include "unity.h"

#define LEAST_DEG 20.0

/* Lever 1:10, K_b = 8.333 µm/N, K_a = 2 µm/N. */
static const sim_seat_t SHARP = {
    .spring_n = 4.0,
    .seat_mm = 5.0,
    .stylus_mm = 50.0,
    .stem_n_m2 = 5.0,
    .axial_um_n = 2.0,
    .azimuth_deg = LEAST_DEG,
    .reseat_um = 0.5,
};

static sim_seat_t seat;

void setUp(void)
{
    seat = SHARP;
}

void tearDown(void)
{
}

void test_a_push_towards_least_force_works_against_the_whole_lever(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4, sim_seat_force_n(&seat, LEAST_DEG, 0.0));
}

void test_between_two_of_them_the_lever_is_half_as_long(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.8, sim_seat_force_n(&seat, LEAST_DEG + 60.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.8, sim_seat_force_n(&seat, LEAST_DEG - 60.0, 0.0));
}

void test_the_force_repeats_every_third_of_a_turn(void)
{
    for (double alpha_deg = -400.0; alpha_deg < 400.0; alpha_deg += 7.0) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, sim_seat_force_n(&seat, alpha_deg, 30.0),
                                  sim_seat_force_n(&seat, alpha_deg + 120.0, 30.0));
    }
}

void test_a_push_along_the_stylus_lifts_the_spring_itself(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0, sim_seat_force_n(&seat, 77.0, 90.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 8.0, sim_seat_pretravel_um(&seat, 77.0, 90.0));
}

void test_an_even_seat_has_no_lobes_and_the_mean_lever(void)
{
    seat.evenness = 1.0;

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4 / 0.827, sim_seat_force_n(&seat, 0.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4 / 0.827, sim_seat_force_n(&seat, 60.0, 0.0));
}

/* A clamped bar of 50 mm with 5 N·m²: L³/(3·E·I) = 8.333 µm/N. */
void test_the_pretravel_is_the_bending_of_a_clamped_bar(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.4 * 25.0 / 3.0, sim_seat_pretravel_um(&seat, LEAST_DEG, 0.0));
}

/* Half the force, by the lever, and eight times the compliance. */
void test_a_stylus_twice_as_long_has_four_times_the_pretravel(void)
{
    double short_um = sim_seat_pretravel_um(&seat, LEAST_DEG, 0.0);
    seat.stylus_mm *= 2.0;

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0 * short_um, sim_seat_pretravel_um(&seat, LEAST_DEG, 0.0));
}

void test_a_push_that_repeats_the_last_one_finds_the_tip_where_it_left_it(void)
{
    sim_rest_t rest = {{0.0}};
    (void)sim_seat_reseat_um(&seat, &rest, 123.0, 45.0);

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, sim_seat_reseat_um(&seat, &rest, 123.0, 45.0));
}

void test_a_push_the_other_way_finds_it_on_either_side(void)
{
    sim_rest_t rest = {{0.0}};

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.5, sim_seat_reseat_um(&seat, &rest, 10.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -1.0, sim_seat_reseat_um(&seat, &rest, 190.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.5, sim_seat_reseat_um(&seat, &rest, 280.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.5, sim_seat_reseat_um(&seat, &rest, 0.0, 90.0));
}
