/* Arithmetic on the wrapping clock: differences, what is left of a duration, microseconds to ticks.
 */
#include "epochs.h"
#include "input/ticks.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

void test_elapsed_counts_right_across_the_wrap(void)
{
    TEST_ASSERT_EQUAL_UINT32(0u, ticks_elapsed(7u, 7u));
    TEST_ASSERT_EQUAL_UINT32(1u, ticks_elapsed(0u, UINT32_MAX));
    TEST_ASSERT_EQUAL_UINT32(20u, ticks_elapsed(9u, 0xFFFFFFF5u));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, ticks_elapsed(6u, 7u));
}

void test_elapsed_of_every_epoch_is_what_was_added(void)
{
    FOR_EACH_EPOCH (since) {
        TEST_ASSERT_EQUAL_UINT32(0x12345678u, ticks_elapsed(since + 0x12345678u, since));
    }
}

void test_left_runs_down_to_zero_and_stays_there(void)
{
    FOR_EACH_EPOCH (since) {
        TEST_ASSERT_EQUAL_UINT32(10u, ticks_left(since, since, 10u));
        TEST_ASSERT_EQUAL_UINT32(1u, ticks_left(since + 9u, since, 10u));
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(since + 10u, since, 10u));
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(since + 11u, since, 10u));
    }
}

void test_nothing_is_left_for_three_quarters_of_the_range(void)
{
    FOR_EACH_EPOCH (since) {
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(since + 0x7FFFFFFFu, since, 10u));
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(since + 0x80000000u, since, 10u));
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(since + 0xBFFFFFFFu, since, 10u));
    }
}

void test_all_is_left_when_now_was_read_before_since(void)
{
    FOR_EACH_EPOCH (since) {
        TEST_ASSERT_EQUAL_UINT32(10u, ticks_left(since - 1u, since, 10u));
        TEST_ASSERT_EQUAL_UINT32(10u, ticks_left(since - 0x40000000u, since, 10u));
    }
}

void test_no_duration_is_over_at_once(void)
{
    TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(5u, 5u, 0u));
    TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(6u, 5u, 0u));
}

/* A task that looks a little late has to find the time over all the same. */
void test_the_longest_duration_is_still_over_a_while_after_its_end(void)
{
    FOR_EACH_EPOCH (since) {
        uint32_t end = since + TICKS_MAX_DURATION;

        TEST_ASSERT_EQUAL_UINT32(1u, ticks_left(end - 1u, since, TICKS_MAX_DURATION));
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(end, since, TICKS_MAX_DURATION));
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(end + 1u, since, TICKS_MAX_DURATION));
        TEST_ASSERT_EQUAL_UINT32(0u, ticks_left(end + 0x40000000u, since, TICKS_MAX_DURATION));
    }
}

void test_never_is_longer_than_any_duration(void)
{
    TEST_ASSERT_GREATER_THAN_UINT32(TICKS_MAX_DURATION, TICKS_NEVER);
}

void test_microseconds_become_ticks(void)
{
    TEST_ASSERT_EQUAL_UINT32(0u, ticks_from_us(0u, 250000u));
    TEST_ASSERT_EQUAL_UINT32(4u, ticks_from_us(1u, 250000u));
    TEST_ASSERT_EQUAL_UINT32(16000u, ticks_from_us(4000u, 250000u));
    TEST_ASSERT_EQUAL_UINT32(72u, ticks_from_us(1u, 13889u));
}

void test_a_part_of_a_tick_counts_as_a_whole_one(void)
{
    TEST_ASSERT_EQUAL_UINT32(1u, ticks_from_us(1u, 1000000000u));
    TEST_ASSERT_EQUAL_UINT32(1u, ticks_from_us(1000u, 1000000000u));
    TEST_ASSERT_EQUAL_UINT32(2u, ticks_from_us(1001u, 1000000000u));
    TEST_ASSERT_EQUAL_UINT32(1u, ticks_from_us(1u, 1000000u));
    TEST_ASSERT_EQUAL_UINT32(2u, ticks_from_us(1u, 999999u));
}

void test_long_times_are_cut_to_the_longest_duration(void)
{
    TEST_ASSERT_EQUAL_UINT32(TICKS_MAX_DURATION - 1u,
                             ticks_from_us(TICKS_MAX_DURATION - 1u, 1000000u));
    TEST_ASSERT_EQUAL_UINT32(TICKS_MAX_DURATION, ticks_from_us(TICKS_MAX_DURATION, 1000000u));
    TEST_ASSERT_EQUAL_UINT32(TICKS_MAX_DURATION, ticks_from_us(TICKS_MAX_DURATION + 1u, 1000000u));
    TEST_ASSERT_EQUAL_UINT32(TICKS_MAX_DURATION, ticks_from_us(UINT32_MAX, 1u));
}
