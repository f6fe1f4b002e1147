/* Motions that take too long. */
/* LINK: firmware/cycle/touch_cycle*.c firmware/input/latch.c
 *       tests/support/cycle_bench.c tests/support/fake_critical.c */
/* MOCK: hal/include/hal_clock.h */
#include "cycle_bench.h"
#include "epochs.h"
#include "fake_critical.h"
#include "input/ticks.h"
#include "mock_hal_clock.h"
#include "unity.h"

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

/* ---- timeouts ---- */

static void check_times_out_after(uint32_t left)
{
    touch_state_t state = bench.cycle.state;
    bench_pass(&bench, left - 1u);
    TEST_ASSERT_EQUAL(state, bench_poll(&bench));
    bench_check_no_request(&bench);
    bench_pass(&bench, 1u);

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
    bench_check_failed(&bench, TOUCH_ERR_TIMEOUT, true);
}

void test_an_approach_that_does_not_end_times_out_to_the_tick(void)
{
    FOR_EACH_EPOCH (epoch) {
        bench_set_going(&bench, epoch, &BENCH_ONE_TOUCH);
        check_times_out_after(BENCH_TIMEOUT);
    }
}

void test_every_motion_has_the_whole_time(void)
{
    bench_set_going(&bench, 1000u, &BENCH_TWO_TOUCHES);
    bench_pass(&bench, BENCH_TIMEOUT - 200u);
    bench_touch_surface(&bench);
    bench_pass(&bench, BENCH_TIMEOUT - 1u);
    TEST_ASSERT_EQUAL(TOUCH_STOPPING, bench_poll(&bench));
    (void)bench_rest(&bench, BENCH_SURFACE + 100);
    bench_carry_out(&bench);
    bench_pass(&bench, BENCH_TIMEOUT - 1u);
    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, bench_poll(&bench));
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    (void)bench_rest(&bench, BENCH_SURFACE - BENCH_BACK_OFF);
    bench_carry_out(&bench);

    check_times_out_after(BENCH_TIMEOUT);
}

void test_a_stop_that_does_not_end_times_out(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_touch_surface(&bench);
    check_times_out_after(BENCH_TIMEOUT);
}

void test_a_return_that_does_not_end_times_out(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_retreat(&bench);
    bench_release_and_poll(&bench);
    check_times_out_after(BENCH_TIMEOUT - BENCH_UNDER_WAY);
}

void test_a_back_off_that_does_not_end_times_out(void)
{
    bench_set_going(&bench, 1000u, &BENCH_TWO_TOUCHES);
    bench_retreat(&bench);
    check_times_out_after(BENCH_TIMEOUT - BENCH_UNDER_WAY);
}

void test_after_a_timeout_the_latch_takes_no_more(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_pass(&bench, BENCH_TIMEOUT);
    (void)bench_poll(&bench);
    bench_touch(&bench, BENCH_SURFACE);

    TEST_ASSERT_EQUAL_UINT16(1u, latch_counters(&bench.latch).unarmed);
}

void test_a_touch_in_the_last_tick_is_in_time(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_pass(&bench, BENCH_TIMEOUT);
    bench_touch(&bench, BENCH_SURFACE);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, bench_poll(&bench));
}

void test_without_a_timeout_a_motion_may_take_for_ever(void)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.timeout_us = 0u;
    bench_set_going(&bench, 1000u, &config);
    for (uint32_t i = 0u; i < 20u; ++i) {
        bench_pass(&bench, 0x10000001u);
        TEST_ASSERT_EQUAL(TOUCH_APPROACHING, bench_poll(&bench));
    }
    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER,
                             touch_cycle_idle_ticks(&bench.cycle, bench.input.now_ticks));
}

/* 2^32 µs are more ticks than the clock can tell. */
void test_a_timeout_too_long_for_the_clock_is_cut_and_still_found(void)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.timeout_us = UINT32_MAX;
    bench_set_going(&bench, 1000u, &config);
    bench_pass(&bench, TICKS_MAX_DURATION - 1u);
    TEST_ASSERT_EQUAL(TOUCH_APPROACHING, bench_poll(&bench));
    bench_pass(&bench, 1000u);

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
}

void test_times_are_given_in_microseconds_whatever_the_tick(void)
{
    hal_clock_tick_ps_StopIgnore();
    hal_clock_tick_ps_IgnoreAndReturn(BENCH_TICK_PS / 4u);
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);

    check_times_out_after(4u * BENCH_TIMEOUT);
}
