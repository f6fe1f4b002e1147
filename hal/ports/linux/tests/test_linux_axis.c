/* hal/ports/linux/axis.h: a position that follows from the clock. */
/* LINK: hal/ports/linux/axis.c hal/ports/linux/clock.c */
#include "../hal/ports/linux/axis.h"
#include "../hal/ports/linux/clock.h"
#include "hal_axis.h"
#include "unity.h"

void setUp(void)
{
    axis_place(0);
    axis_follow();
}

void tearDown(void)
{
}

static int32_t position_at_ns(uint64_t ns)
{
    axis_capture(ns);
    return hal_axis_position_counts(0u);
}

void test_the_position_is_speed_times_time(void)
{
    axis_run(100000.0);

    TEST_ASSERT_EQUAL_INT32(0, position_at_ns(0u));
    TEST_ASSERT_EQUAL_INT32(1, position_at_ns(10000u));
    TEST_ASSERT_EQUAL_INT32(100000, position_at_ns(CLOCK_NS_PER_S));
}

void test_the_position_is_rounded_to_the_nearest_count(void)
{
    axis_run(100000.0);

    TEST_ASSERT_EQUAL_INT32(0, position_at_ns(4999u));
    TEST_ASSERT_EQUAL_INT32(1, position_at_ns(5001u));
}

void test_the_position_wraps_like_a_counter(void)
{
    axis_run(1.0e9);

    TEST_ASSERT_EQUAL_INT32(INT32_MAX, position_at_ns(2147483647u));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, position_at_ns(2147483648u));
    TEST_ASSERT_EQUAL_INT32(0, position_at_ns(4294967296u));
}

/* Thirty years after the machine was started. */
void test_a_long_time_costs_no_count(void)
{
    const uint64_t years_ns = 946080000ull * CLOCK_NS_PER_S;
    axis_run(100000.0);

    TEST_ASSERT_EQUAL_INT32(100000,
                            position_at_ns(years_ns + CLOCK_NS_PER_S) - position_at_ns(years_ns));
}

void test_a_placed_axis_stands_still(void)
{
    axis_run(100000.0);
    axis_place(-4711);

    TEST_ASSERT_EQUAL_INT32(-4711, position_at_ns(CLOCK_NS_PER_S));
    TEST_ASSERT_EQUAL_INT32(-4711, position_at_ns(2u * (uint64_t)CLOCK_NS_PER_S));
}

void test_after_a_capture_the_position_is_that_of_now_again(void)
{
    axis_run(1.0e6);
    int32_t captured = position_at_ns(0u);
    axis_follow();
    int32_t before = (int32_t)(uint32_t)(clock_now_ns() / CLOCK_NS_PER_US);
    int32_t now = hal_axis_position_counts(0u);

    TEST_ASSERT_EQUAL_INT32(0, captured);
    TEST_ASSERT_INT32_WITHIN(1000000, 0, (int32_t)((uint32_t)now - (uint32_t)before));
}

void test_another_axis_reads_zero(void)
{
    axis_place(4711);

    TEST_ASSERT_EQUAL_INT32(0, hal_axis_position_counts(1u));
}
