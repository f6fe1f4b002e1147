/* Overtravel and the feed that keeps it within bounds: v·t + v²/2a and its inverse. */
/* LINK: firmware/cycle/overtravel.c */
#include <math.h>

#include "cycle/overtravel.h"
#include "unity.h"

static const overtravel_path_t NO_REACTION = {.reaction_us = 0.0, .accel_mm_s2 = 1000.0};
static const overtravel_path_t ONE_SCAN = {.reaction_us = 4000.0, .accel_mm_s2 = 3000.0};

void setUp(void)
{
}

void tearDown(void)
{
}

void test_without_reaction_only_the_deceleration_is_left(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5000.0, overtravel_um(&NO_REACTION, 6000.0));
}

void test_with_endless_deceleration_only_the_reaction_is_left(void)
{
    const overtravel_path_t path = {.reaction_us = 4000.0, .accel_mm_s2 = 1e15};

    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 200.0, overtravel_um(&path, 3000.0)); /* the seed's 0.2 mm */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0, overtravel_um(&path, 30.0));
}

void test_both_parts_add_up(void)
{
    double deceleration_um = 50.0 * 50.0 / (2.0 * 3000.0) * 1000.0;

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 200.0 + deceleration_um, overtravel_um(&ONE_SCAN, 3000.0));
}

void test_an_axis_at_rest_has_no_overtravel(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, overtravel_um(&ONE_SCAN, 0.0));
}

void test_the_safe_feed_has_just_the_allowed_overtravel(void)
{
    for (double allowed_um = 1e-3; allowed_um < 1e6; allowed_um *= 3.0) {
        for (double reaction_us = 0.0; reaction_us < 1e6; reaction_us = 2.0 * reaction_us + 1.0) {
            overtravel_path_t path = {.reaction_us = reaction_us, .accel_mm_s2 = 2500.0};
            double            feed_mm_min = overtravel_safe_feed_mm_min(&path, allowed_um);

            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * allowed_um, allowed_um,
                                      overtravel_um(&path, feed_mm_min));
        }
    }
}

/* The usual form of the root would cancel to nothing here. */
void test_a_long_reaction_costs_no_accuracy(void)
{
    const overtravel_path_t path = {.reaction_us = 1e9, .accel_mm_s2 = 1e6};

    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 60e-9, overtravel_safe_feed_mm_min(&path, 1e-3));
}

void test_where_nothing_is_allowed_nothing_may_move(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, overtravel_safe_feed_mm_min(&ONE_SCAN, 0.0));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, overtravel_safe_feed_mm_min(&NO_REACTION, 0.0));
}

/* Far below what any axis can be told to do, squares and quotients vanish. */
void test_an_allowance_that_is_next_to_nothing_gives_a_feed_that_is_finite(void)
{
    for (double allowed_um = 1e-280; allowed_um > 0.0; allowed_um /= 10.0) {
        double feed_mm_min = overtravel_safe_feed_mm_min(&NO_REACTION, allowed_um);
        TEST_ASSERT_TRUE(feed_mm_min >= 0.0 && feed_mm_min < 1e-100);
    }
}

void test_any_lower_feed_is_safe(void)
{
    double feed_mm_min = overtravel_safe_feed_mm_min(&ONE_SCAN, 100.0);

    for (double share = 0.999; share > 0.0; share -= 0.05) {
        TEST_ASSERT_TRUE(overtravel_um(&ONE_SCAN, share * feed_mm_min) < 100.0);
    }
    TEST_ASSERT_TRUE(overtravel_um(&ONE_SCAN, 1.001 * feed_mm_min) > 100.0);
}
