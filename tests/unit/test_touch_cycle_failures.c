/* Cycles that fail on the way: no touch, trouble on the way back. */
/* LINK: firmware/cycle/touch_cycle*.c firmware/input/latch.c
 *       tests/support/cycle_bench.c tests/support/fake_critical.c */
/* MOCK: hal/include/hal_clock.h */
#include "cycle_bench.h"
#include "epochs.h"
#include "fake_critical.h"
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

static void check_refused(touch_error_t error)
{
    bench_check_failed(&bench, error, false);
}

/* ---- no touch ---- */

void test_standstill_without_a_touch_is_a_failure(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_pass(&bench, 1000u);

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_rest(&bench, BENCH_END));
    check_refused(TOUCH_ERR_NO_TOUCH);
}

void test_standstill_without_the_second_touch_is_a_failure(void)
{
    bench_set_going(&bench, 1000u, &BENCH_TWO_TOUCHES);
    bench_retreat(&bench);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    (void)bench_rest(&bench, BENCH_SURFACE - BENCH_BACK_OFF);
    bench_carry_out(&bench);
    TEST_ASSERT_EQUAL(TOUCH_MEASURING, bench_poll(&bench));

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_rest(&bench, BENCH_END));
    check_refused(TOUCH_ERR_NO_TOUCH);
}

void test_a_touch_at_the_very_end_of_the_travel_counts(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_touch(&bench, BENCH_END);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, bench_rest(&bench, BENCH_END));
}

void test_an_edge_that_waits_at_the_end_of_the_travel_is_waited_for(void)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.confirm_us = 200u;
    bench_set_going(&bench, 1000u, &config);
    bench_touch(&bench, BENCH_END);
    TEST_ASSERT_EQUAL(TOUCH_APPROACHING, bench_rest(&bench, BENCH_END));
    bench_pass(&bench, 200u);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, bench_poll(&bench));
}

void test_an_edge_at_the_end_of_the_travel_may_turn_out_a_glitch(void)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.confirm_us = 200u;
    bench_set_going(&bench, 1000u, &config);
    bench_touch(&bench, BENCH_END);
    (void)bench_rest(&bench, BENCH_END);
    bench_release_and_poll(&bench);
    bench_pass(&bench, 200u);

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
    check_refused(TOUCH_ERR_NO_TOUCH);
}

void test_after_a_failure_the_latch_takes_no_more(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    (void)bench_rest(&bench, BENCH_END);
    latch_on_edge(&bench.latch, 5000u, 0);

    TEST_ASSERT_EQUAL_UINT16(1u, latch_counters(&bench.latch).unarmed);
}

/* The poll that finds the axis at rest without a touch shuts the door before it looks. */
static unsigned sections_left;

static void touch_between_sections(void)
{
    if (sections_left > 0u && --sections_left == 0u) {
        latch_on_edge(&bench.latch, bench.input.now_ticks, BENCH_END);
    }
}

void test_an_edge_at_any_instant_of_the_last_poll_is_taken_or_counted(void)
{
    for (unsigned section = 1u; section < 10u; ++section) {
        bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
        fake_critical_reset(touch_between_sections);
        sections_left = section;
        touch_state_t state = bench_rest(&bench, BENCH_END);
        bool          has_come = sections_left == 0u;
        fake_critical_reset(NULL);
        unsigned unarmed = latch_counters(&bench.latch).unarmed;

        TEST_ASSERT_TRUE(state == TOUCH_MEASURED || state == TOUCH_FAILED);
        TEST_ASSERT_EQUAL_UINT(state == TOUCH_FAILED && has_come ? 1u : 0u, unarmed);
    }
}

/* ---- the way back ---- */

void test_a_release_that_bounces_within_the_hold_off_is_no_error(void)
{
    FOR_EACH_EPOCH (epoch) {
        bench_set_going(&bench, epoch, &BENCH_ONE_TOUCH);
        bench_retreat(&bench);
        bench_release_and_poll(&bench);
        bench_pass(&bench, BENCH_HOLDOFF - 1u);
        bench.is_deflected = true;
        TEST_ASSERT_EQUAL(TOUCH_RETURNING, bench_poll(&bench));
        bench_release_and_poll(&bench);
        bench_pass(&bench, 10u * BENCH_HOLDOFF);

        TEST_ASSERT_EQUAL(TOUCH_RETURNING, bench_poll(&bench));
        TEST_ASSERT_EQUAL(TOUCH_DONE, bench_rest(&bench, BENCH_START));
    }
}

void test_deflected_again_after_the_hold_off_is_an_error(void)
{
    FOR_EACH_EPOCH (epoch) {
        bench_set_going(&bench, epoch, &BENCH_ONE_TOUCH);
        bench_retreat(&bench);
        bench_release_and_poll(&bench);
        bench_pass(&bench, BENCH_HOLDOFF);
        bench.is_deflected = true;

        TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
        bench_check_failed(&bench, TOUCH_ERR_DEFLECTED_IN_RETREAT, true);
    }
}

void test_deflected_again_at_the_standstill_is_an_error_all_the_same(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_retreat(&bench);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    bench.is_deflected = true;

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_rest(&bench, BENCH_START));
    bench_check_failed(&bench, TOUCH_ERR_DEFLECTED_IN_RETREAT, true);
}

/* A contact that opened while the axis was stopping may bounce when it starts to go back. */
void test_a_probe_free_before_the_retreat_has_its_hold_off_from_there(void)
{
    for (uint32_t after = BENCH_HOLDOFF - 1u; after <= BENCH_HOLDOFF; ++after) {
        bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
        bench_touch_surface(&bench);
        bench_release_and_poll(&bench);
        bench_pass(&bench, 50u * BENCH_HOLDOFF);
        (void)bench_rest(&bench, BENCH_SURFACE + 100);
        bench_carry_out(&bench);
        (void)bench_poll(&bench);
        bench_pass(&bench, after);
        bench.is_deflected = true;

        TEST_ASSERT_EQUAL(after < BENCH_HOLDOFF ? TOUCH_RETURNING : TOUCH_FAILED,
                          bench_poll(&bench));
    }
}

void test_deflected_again_while_backing_off_is_an_error(void)
{
    bench_set_going(&bench, 1000u, &BENCH_TWO_TOUCHES);
    bench_retreat(&bench);
    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, bench_poll(&bench));
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    bench.is_deflected = true;

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
    bench_check_failed(&bench, TOUCH_ERR_DEFLECTED_IN_RETREAT, true);
}

void test_deflected_from_the_touch_on_is_no_error_on_the_way_back(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_retreat(&bench);
    bench_pass(&bench, 100u * BENCH_HOLDOFF);

    TEST_ASSERT_EQUAL(TOUCH_RETURNING, bench_poll(&bench));
    bench_check_no_request(&bench);
}

void test_the_release_may_come_late_by_the_settling_time(void)
{
    FOR_EACH_EPOCH (epoch) {
        bench_set_going(&bench, epoch, &BENCH_ONE_TOUCH);
        bench_retreat(&bench);
        TEST_ASSERT_EQUAL(TOUCH_RETURNING, bench_rest(&bench, BENCH_START));
        bench_pass(&bench, BENCH_SETTLE - 1u);
        TEST_ASSERT_EQUAL(TOUCH_RETURNING, bench_poll(&bench));
        bench_pass(&bench, 1u);

        TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
        check_refused(TOUCH_ERR_STUCK_DEFLECTED);
    }
}

void test_a_late_release_ends_the_cycle_well(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_retreat(&bench);
    (void)bench_rest(&bench, BENCH_START);
    bench_pass(&bench, BENCH_SETTLE - 1u);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);

    TEST_ASSERT_EQUAL(TOUCH_DONE, bench_poll(&bench));
}

void test_a_probe_stuck_after_the_back_off_is_an_error(void)
{
    bench_set_going(&bench, 1000u, &BENCH_TWO_TOUCHES);
    bench_retreat(&bench);
    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, bench_rest(&bench, BENCH_SURFACE - BENCH_BACK_OFF));
    bench_pass(&bench, BENCH_SETTLE);

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
    check_refused(TOUCH_ERR_STUCK_DEFLECTED);
}

/* The hold-off covers the bounces of a release too: one of them is not the second touch. */
void test_a_release_at_the_end_of_the_back_off_may_bounce(void)
{
    bench_set_going(&bench, 1000u, &BENCH_TWO_TOUCHES);
    bench_retreat(&bench);
    (void)bench_rest(&bench, BENCH_SURFACE - BENCH_BACK_OFF);
    bench_release_and_poll(&bench);
    bench_carry_out(&bench);
    bench_pass(&bench, 1u);
    bench_touch(&bench, BENCH_SURFACE - BENCH_BACK_OFF);
    (void)bench_poll(&bench);
    TEST_ASSERT_EQUAL_MESSAGE(TOUCH_OK, bench.cycle.result.error, "failed");
    bench_release_and_poll(&bench);
    bench_carry_out(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    (void)bench_poll(&bench);

    TEST_ASSERT_EQUAL(TOUCH_MEASURING, bench.cycle.state);
}

/* Neither is it a touch between two cycles. */
void test_a_release_at_the_end_of_the_return_may_bounce(void)
{
    bench_set_going(&bench, 1000u, &BENCH_ONE_TOUCH);
    bench_retreat(&bench);
    (void)bench_rest(&bench, BENCH_START);
    bench_release_and_poll(&bench);
    bench_pass(&bench, 1u);
    bench_touch(&bench, BENCH_START);
    (void)bench_poll(&bench);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    TEST_ASSERT_EQUAL(TOUCH_DONE, bench_poll(&bench));

    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_ONE_TOUCH));
}
