/* hal/ports/linux/clock.h: ticks of CLOCK_MONOTONIC, and the other clock brought to it. */
/* LINK: hal/ports/linux/clock.c */
#include <time.h>

#include "../hal/ports/linux/clock.h"
#include "hal_clock.h"
#include "input/ticks.h"
#include "unity.h"

#define NS_OF_ALL_TICKS (4294967296ull * CLOCK_TICK_NS)
#define READING_NS      100000000u /* two readings of a clock are never that far apart */

void setUp(void)
{
}

void tearDown(void)
{
    clock_shift_ticks(0u);
}

void test_a_tick_is_a_hundred_nanoseconds(void)
{
    TEST_ASSERT_EQUAL_UINT32(100000u, hal_clock_tick_ps());
    TEST_ASSERT_EQUAL_UINT32(10000000u, clock_ticks_of_ns(CLOCK_NS_PER_S));
}

void test_an_instant_is_rounded_down_to_its_tick(void)
{
    TEST_ASSERT_EQUAL_UINT32(0u, clock_ticks_of_ns(99u));
    TEST_ASSERT_EQUAL_UINT32(1u, clock_ticks_of_ns(100u));
    TEST_ASSERT_EQUAL_UINT32(1u, clock_ticks_of_ns(199u));
}

void test_ticks_wrap_at_32_bits(void)
{
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, clock_ticks_of_ns(NS_OF_ALL_TICKS - 1u));
    TEST_ASSERT_EQUAL_HEX32(0u, clock_ticks_of_ns(NS_OF_ALL_TICKS));
    TEST_ASSERT_EQUAL_HEX32(5u, clock_ticks_of_ns(7u * NS_OF_ALL_TICKS + 5u * CLOCK_TICK_NS));
}

void test_a_difference_of_ticks_holds_right_across_the_wrap(void)
{
    for (uint64_t before_ns = 0u; before_ns < 3000u; before_ns += 50u) {
        uint32_t since = clock_ticks_of_ns(NS_OF_ALL_TICKS - before_ns);
        uint32_t now = clock_ticks_of_ns(NS_OF_ALL_TICKS - before_ns + 1500u);

        TEST_ASSERT_EQUAL_UINT32(15u, ticks_elapsed(now, since));
    }
}

void test_the_ticks_of_now_are_those_of_the_monotonic_clock(void)
{
    uint32_t before = clock_ticks_of_ns(clock_now_ns());
    uint32_t now = hal_clock_now_ticks();
    uint32_t after = clock_ticks_of_ns(clock_now_ns());

    TEST_ASSERT_LESS_OR_EQUAL_UINT32(ticks_elapsed(after, before), ticks_elapsed(now, before));
}

void test_shifted_ticks_run_on_from_there(void)
{
    clock_shift_ticks(UINT32_MAX - 10u - hal_clock_now_ticks());

    TEST_ASSERT_LESS_THAN_UINT32(READING_NS / CLOCK_TICK_NS,
                                 ticks_elapsed(hal_clock_now_ticks(), UINT32_MAX - 10u));
}

void test_a_realtime_stamp_is_brought_to_the_monotonic_clock(void)
{
    struct timespec realtime;
    uint64_t        before_ns = clock_now_ns();
    (void)clock_gettime(CLOCK_REALTIME, &realtime);
    uint64_t after_ns = clock_now_ns();
    uint64_t stamp_ns = clock_monotonic_of_realtime_ns((uint64_t)realtime.tv_sec * CLOCK_NS_PER_S +
                                                       (uint64_t)realtime.tv_nsec);

    TEST_ASSERT_UINT64_WITHIN(READING_NS, before_ns, stamp_ns);
    TEST_ASSERT_UINT64_WITHIN(READING_NS, after_ns, stamp_ns);
}

void test_an_older_realtime_stamp_is_older_by_as_much(void)
{
    struct timespec realtime;
    uint64_t        now_ns = clock_now_ns();
    (void)clock_gettime(CLOCK_REALTIME, &realtime);
    uint64_t earlier_ns =
        (uint64_t)(realtime.tv_sec - 1) * CLOCK_NS_PER_S + (uint64_t)realtime.tv_nsec;

    TEST_ASSERT_UINT64_WITHIN(READING_NS, now_ns - CLOCK_NS_PER_S,
                              clock_monotonic_of_realtime_ns(earlier_ns));
}
