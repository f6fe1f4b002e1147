/* How many lines a pulse stands for, on both sides of every limit. */
/* LINK: firmware/comp/pulse_judge.c */
#include "comp/pulse_judge.h"
#include "unity.h"

#define LINE 1000u

static pulse_train_t train;

void setUp(void)
{
    train = (pulse_train_t){0};
}

void tearDown(void)
{
}

static void check_counters(uint32_t missing, uint32_t extra, uint32_t slips)
{
    TEST_ASSERT_EQUAL_UINT32(missing, train.counters.missing);
    TEST_ASSERT_EQUAL_UINT32(extra, train.counters.extra);
    TEST_ASSERT_EQUAL_UINT32(slips, train.counters.slips);
}

static void run_evenly(uint32_t interval_ticks)
{
    for (int i = 0; i <= PULSE_STEADY; ++i) {
        TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, interval_ticks));
    }
}

void test_a_line_may_be_a_quarter_shorter_or_longer(void)
{
    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge(&train, 750u, LINE));
    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge(&train, 1250u, LINE));

    check_counters(0u, 0u, 0u);
}

void test_a_pulse_that_comes_earlier_is_extra(void)
{
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 749u, LINE));
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 0u, LINE));
    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge(&train, LINE, LINE));

    check_counters(0u, 2u, 0u);
}

void test_whole_lines_without_a_pulse_are_missing(void)
{
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 1751u, LINE));
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 2250u, LINE));
    TEST_ASSERT_EQUAL_UINT8(PULSE_MISSING_MAX, pulse_judge(&train, PULSE_MISSING_MAX * LINE, LINE));

    check_counters(1u + 1u + PULSE_MISSING_MAX - 1u, 0u, 0u);
}

void test_too_many_lines_are_a_slip(void)
{
    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge(&train, (PULSE_MISSING_MAX + 1u) * LINE, LINE));
    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge(&train, UINT32_MAX, LINE));

    check_counters(0u, 0u, 2u);
}

/* One pulse is missing, and an extra one came about where it was. */
void test_a_pulse_between_two_lines_is_extra_if_a_line_follows_soon(void)
{
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 1251u, LINE));
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 2000u, LINE));
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 1749u, LINE));
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 1751u, LINE));
    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge(&train, LINE, LINE));

    check_counters(2u, 2u, 0u);
}

void test_it_was_a_line_if_none_follows_soon(void)
{
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 1300u, LINE));
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 2050u, LINE));

    check_counters(0u, 0u, 1u);
}

void test_two_pulses_between_lines_were_lines(void)
{
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 1300u, LINE));
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 1600u, LINE));

    check_counters(0u, 0u, 1u);
}

void test_a_pulse_in_doubt_is_forgotten_with_the_rest(void)
{
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 1300u, LINE));
    pulse_judge_forget(&train);
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 2000u, LINE));

    check_counters(1u, 0u, 0u);
}

void test_a_slip_gives_the_pulses_back_that_were_left_out(void)
{
    TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 700u, LINE));
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge(&train, 1400u, LINE));

    check_counters(0u, 0u, 1u);
}

void test_pulses_that_keep_coming_early_are_believed_in_the_end(void)
{
    for (int i = 0; i < PULSE_REJECTED_MAX; ++i) {
        TEST_ASSERT_EQUAL_UINT8(0u, pulse_judge(&train, 10u, LINE));
    }

    TEST_ASSERT_EQUAL_UINT8(PULSE_REJECTED_MAX + 1u, pulse_judge(&train, 10u, LINE));

    check_counters(0u, 0u, 1u);
}

void test_before_it_runs_evenly_every_pulse_is_good(void)
{
    static const uint32_t INTERVALS[] = {1000u, 414u, 318u, 268u, 5000u, 1u, 0u, 700u};
    for (int i = 0; i < 8; ++i) {
        TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, INTERVALS[i]));
    }

    check_counters(0u, 0u, 0u);
}

void test_after_even_intervals_a_double_one_is_a_missing_pulse(void)
{
    run_evenly(LINE);

    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge_ticks(&train, 2u * LINE));
    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, LINE));

    check_counters(1u, 0u, 0u);
}

void test_an_interval_too_few_is_not_even(void)
{
    for (int i = 0; i < PULSE_STEADY; ++i) {
        (void)pulse_judge_ticks(&train, LINE);
    }

    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, 2u * LINE));

    check_counters(0u, 0u, 0u);
}

void test_a_speed_that_changes_by_a_fifth_a_line_is_followed(void)
{
    run_evenly(LINE);
    uint32_t interval = LINE;
    for (int i = 0; i < 20; ++i) {
        interval = interval * 6u / 5u;
        TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, interval));
    }
    for (int i = 0; i < 20; ++i) {
        interval = interval * 4u / 5u;
        TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, interval));
    }

    check_counters(0u, 0u, 0u);
}

/* By turns 0.85 and 1.15 of a line: more than a quarter off the one before, but not off the mean.
 */
void test_lines_of_two_lengths_by_turns_are_good(void)
{
    run_evenly(LINE);
    for (int i = 0; i < 50; ++i) {
        TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, i % 2 == 0 ? 850u : 1150u));
    }

    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge_ticks(&train, 2u * LINE));
    check_counters(1u, 0u, 0u);
}

void test_lines_that_take_too_long_are_not_judged(void)
{
    const uint32_t longest = (1u << 28) - 1u;
    run_evenly(longest);
    TEST_ASSERT_EQUAL_UINT8(2u, pulse_judge_ticks(&train, 2u * longest));
    check_counters(1u, 0u, 0u);
    setUp();

    run_evenly(longest + 1u);

    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, 2u * longest));
    check_counters(0u, 0u, 0u);
}

void test_forgetting_believes_the_next_pulses_again(void)
{
    run_evenly(LINE);

    pulse_judge_forget(&train);

    TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, 5u * LINE));
    check_counters(0u, 0u, 0u);
}

/* Where the clock is too slow for the pulses, nothing can be said, and nothing is. */
void test_intervals_of_a_few_ticks_are_taken_as_they_come(void)
{
    for (uint32_t i = 0u; i < 100u; ++i) {
        TEST_ASSERT_EQUAL_UINT8(1u, pulse_judge_ticks(&train, i % 2u));
    }

    check_counters(0u, 0u, 0u);
}
