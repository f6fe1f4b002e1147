/* Cycles that do not start: settings out of range, a probe that is or was deflected. */
/* LINK: firmware/cycle/touch_cycle*.c firmware/input/latch.c
 *       tests/support/cycle_bench.c tests/support/fake_critical.c */
/* MOCK: hal/include/hal_clock.h */
#include <math.h>

#include "cycle_bench.h"
#include "fake_critical.h"
#include "input/ticks.h"
#include "mock_hal_clock.h"
#include "unity.h"

#define LIMIT 0x10000000 /* the first position that is too far */

static cycle_bench_t bench;

void setUp(void)
{
    fake_critical_reset(NULL);
    hal_clock_tick_ps_IgnoreAndReturn(BENCH_TICK_PS);
    bench_set_up(&bench, 1000u, BENCH_START);
}

void tearDown(void)
{
    fake_critical_verify();
}

static void check_refused(touch_error_t error)
{
    bench_check_failed(&bench, error, false);
}

/* A whole cycle, the release long before the end. */
static void finish_one_touch(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_retreat(&bench);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    TEST_ASSERT_EQUAL(TOUCH_DONE, bench_rest(&bench, BENCH_START));
}

/* ---- configuration ---- */

static void check_config(const touch_config_t *config, touch_error_t expected)
{
    TEST_ASSERT_EQUAL(expected, bench_start(&bench, config));
    if (expected != TOUCH_OK) {
        check_refused(expected);
    }
    bench_set_up(&bench, 1000u, BENCH_START);
}

#define CHECK_CONFIG(base, field, value, expected) \
    do {                                           \
        touch_config_t config_ = (base);           \
        config_.field = (value);                   \
        check_config(&config_, (expected));        \
    } while (false)

void test_an_approach_leads_somewhere_within_bounds(void)
{
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, 1, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, -1, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, LIMIT - 1, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, 1 - LIMIT, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, 0, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, LIMIT, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, -LIMIT, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, approach_counts, INT32_MIN, TOUCH_ERR_CONFIG);
}

void test_it_looks_past_the_surface_within_bounds(void)
{
    CHECK_CONFIG(BENCH_ONE_TOUCH, overtravel_counts, 1, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, overtravel_counts, LIMIT - 1, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, overtravel_counts, 0, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, overtravel_counts, -1, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, overtravel_counts, LIMIT, TOUCH_ERR_CONFIG);
}

void test_a_feed_is_a_positive_number(void)
{
    CHECK_CONFIG(BENCH_ONE_TOUCH, feed_mm_min, 1e-9, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, feed_mm_min, 0.0, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, feed_mm_min, -1.0, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, feed_mm_min, (double)NAN, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_ONE_TOUCH, feed_mm_min, (double)INFINITY, TOUCH_ERR_CONFIG);
}

void test_two_touches_want_a_back_off_and_a_second_feed(void)
{
    CHECK_CONFIG(BENCH_TWO_TOUCHES, back_off_counts, 1, TOUCH_OK);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, back_off_counts, LIMIT - 1, TOUCH_OK);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, back_off_counts, 0, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, back_off_counts, -1, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, back_off_counts, LIMIT, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, measure_feed_mm_min, 1e-9, TOUCH_OK);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, measure_feed_mm_min, 0.0, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, measure_feed_mm_min, (double)NAN, TOUCH_ERR_CONFIG);
    CHECK_CONFIG(BENCH_TWO_TOUCHES, measure_feed_mm_min, (double)INFINITY, TOUCH_ERR_CONFIG);
}

void test_one_touch_does_not_care_for_the_settings_of_two(void)
{
    CHECK_CONFIG(BENCH_ONE_TOUCH, back_off_counts, -1, TOUCH_OK);
    CHECK_CONFIG(BENCH_ONE_TOUCH, measure_feed_mm_min, -1.0, TOUCH_OK);
}

void test_the_axis_starts_within_bounds(void)
{
    static const int32_t good[] = {LIMIT - 1, 1 - LIMIT};
    static const int32_t bad[] = {LIMIT, -LIMIT, INT32_MAX, INT32_MIN};
    for (size_t i = 0u; i < sizeof good / sizeof *good; ++i) {
        bench_set_up(&bench, 0u, good[i]);
        TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_ONE_TOUCH));
    }
    for (size_t i = 0u; i < sizeof bad / sizeof *bad; ++i) {
        bench_set_up(&bench, 0u, bad[i]);
        TEST_ASSERT_EQUAL(TOUCH_ERR_CONFIG, bench_start(&bench, &BENCH_ONE_TOUCH));
    }
}

void test_the_farthest_targets_do_not_overflow(void)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.approach_counts = LIMIT - 1;
    config.overtravel_counts = LIMIT - 1;
    bench_set_up(&bench, 0u, LIMIT - 1);
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &config));

    bench_check_move(&bench, 3 * (LIMIT - 1), BENCH_FAST);
}

void test_a_cycle_that_was_refused_stays_so_and_can_be_started_anew(void)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.approach_counts = 0;
    (void)bench_start(&bench, &config);
    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER, touch_cycle_idle_ticks(&bench.cycle, 0u));

    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_ONE_TOUCH));
}

void test_a_cycle_that_is_refused_forgets_what_the_last_one_asked_for(void)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.approach_counts = 0;
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_ONE_TOUCH)); /* nobody moves */

    (void)bench_start(&bench, &config);
    check_refused(TOUCH_ERR_CONFIG);
}

/* ---- deflected, or touched, before the start ---- */

void test_a_probe_deflected_at_the_start_moves_nothing(void)
{
    bench.is_deflected = true;

    TEST_ASSERT_EQUAL(TOUCH_ERR_DEFLECTED_AT_START, bench_start(&bench, &BENCH_ONE_TOUCH));
    check_refused(TOUCH_ERR_DEFLECTED_AT_START);
}

void test_the_latch_is_not_armed_by_a_cycle_that_was_refused(void)
{
    bench.is_deflected = true;
    (void)bench_start(&bench, &BENCH_ONE_TOUCH);
    latch_on_edge(&bench.latch, 1001u, 0);

    TEST_ASSERT_EQUAL_UINT16(1u, latch_counters(&bench.latch).unarmed);
}

void test_a_touch_between_two_cycles_is_told_at_the_next_start_and_once(void)
{
    finish_one_touch();
    bench_touch(&bench, BENCH_START);
    bench_release(&bench);

    TEST_ASSERT_EQUAL(TOUCH_ERR_UNARMED_TOUCH, bench_start(&bench, &BENCH_ONE_TOUCH));
    check_refused(TOUCH_ERR_UNARMED_TOUCH);
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_ONE_TOUCH));
}

void test_a_touch_before_the_first_cycle_is_told(void)
{
    bench_touch(&bench, BENCH_START);
    bench_release(&bench);

    TEST_ASSERT_EQUAL(TOUCH_ERR_UNARMED_TOUCH, bench_start(&bench, &BENCH_ONE_TOUCH));
}

void test_a_touch_after_a_failure_is_told(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    (void)bench_rest(&bench, BENCH_END);
    check_refused(TOUCH_ERR_NO_TOUCH);
    bench_touch(&bench, BENCH_START);
    bench_release(&bench);

    TEST_ASSERT_EQUAL(TOUCH_ERR_UNARMED_TOUCH, bench_start(&bench, &BENCH_ONE_TOUCH));
}
