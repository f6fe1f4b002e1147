/* Cycles of one and of two touches that go as they should. */
/* LINK: firmware/cycle/touch_cycle*.c firmware/input/latch.c
 *       tests/support/cycle_bench.c tests/support/fake_critical.c */
/* MOCK: hal/include/hal_clock.h */
#include "cycle_bench.h"
#include "fake_critical.h"
#include "input/ticks.h"
#include "mock_hal_clock.h"
#include "unity.h"

#define START    100000
#define APPROACH 5000
#define BEYOND   2000
#define SURFACE  (START + APPROACH)
#define BACK_OFF 300
#define FAST     3000.0
#define SLOW     30.0

static const touch_config_t ONE = {
    .approach_counts = APPROACH, .overtravel_counts = BEYOND, .feed_mm_min = FAST};
static const touch_config_t TWO = {.two_touches = true,
                                   .approach_counts = APPROACH,
                                   .overtravel_counts = BEYOND,
                                   .back_off_counts = BACK_OFF,
                                   .feed_mm_min = FAST,
                                   .measure_feed_mm_min = SLOW};

static cycle_bench_t bench;

void setUp(void)
{
    fake_critical_reset(NULL);
    hal_clock_tick_ps_IgnoreAndReturn(BENCH_TICK_PS);
    bench_set_up(&bench, 1000u, START);
}

void tearDown(void)
{
    fake_critical_verify();
}

static touch_config_t backwards(touch_config_t config)
{
    config.approach_counts = -config.approach_counts;
    return config;
}

static void start(touch_config_t config)
{
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &config));
    bench_carry_out(&bench);
}

/* The axis passes `position_counts` a while after the last motion began, and the probe triggers. */
static touch_state_t touch_at(int32_t position_counts)
{
    bench_pass(&bench, 100000u);
    bench_touch(&bench, position_counts);
    return bench_poll(&bench);
}

static touch_state_t rest_at(int32_t position_counts)
{
    bench_pass(&bench, 20000u);
    return bench_rest(&bench, position_counts);
}

/* The probe lets go on the way back, and the axis comes to rest. */
static touch_state_t release_and_rest_at(int32_t position_counts)
{
    bench_pass(&bench, 5000u);
    bench_release(&bench);
    (void)bench_poll(&bench);
    return rest_at(position_counts);
}

/* ---- one touch ---- */

void test_a_new_cycle_is_idle_and_wants_nothing(void)
{
    TEST_ASSERT_EQUAL(TOUCH_IDLE, bench_poll(&bench));
    bench_check_no_request(&bench);
    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER, touch_cycle_idle_ticks(&bench.cycle, 0u));
}

void test_it_drives_past_the_surface_by_the_overtravel(void)
{
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &ONE));

    bench_check_move(&bench, START + APPROACH + BEYOND, FAST);
    TEST_ASSERT_EQUAL(TOUCH_APPROACHING, bench_poll(&bench));
    bench_check_no_request(&bench);
}

void test_it_drives_the_other_way_too(void)
{
    const touch_config_t config = backwards(ONE);
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &config));

    bench_check_move(&bench, START - APPROACH - BEYOND, FAST);
}

void test_the_touch_stops_the_axis(void)
{
    start(ONE);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, touch_at(SURFACE));
    bench_check_stop(&bench);
}

void test_the_latch_is_there_as_soon_as_the_touch_and_once(void)
{
    latch_record_t record;
    start(ONE);
    TEST_ASSERT_FALSE(touch_cycle_take_latch(&bench.cycle, &record));
    (void)touch_at(SURFACE + 7);

    TEST_ASSERT_TRUE(touch_cycle_take_latch(&bench.cycle, &record));
    TEST_ASSERT_EQUAL_UINT32(101000u, record.ticks);
    TEST_ASSERT_EQUAL_INT32(SURFACE + 7, record.position_counts);
    TEST_ASSERT_FALSE(touch_cycle_take_latch(&bench.cycle, &record));
}

void test_it_waits_for_the_standstill(void)
{
    start(ONE);
    (void)touch_at(SURFACE);
    bench_check_stop(&bench);
    bench_pass(&bench, 10000u);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, bench_poll(&bench));
    bench_check_no_request(&bench);
}

void test_it_returns_to_the_start_at_the_first_feed(void)
{
    start(ONE);
    (void)touch_at(SURFACE);
    bench_check_stop(&bench);

    TEST_ASSERT_EQUAL(TOUCH_RETURNING, rest_at(SURFACE + 400));
    bench_check_move(&bench, START, FAST);
}

void test_the_overtravel_counts_along_the_approach(void)
{
    start(ONE);
    (void)touch_at(SURFACE + 3);
    (void)rest_at(SURFACE + 403);

    TEST_ASSERT_EQUAL_INT32(400, touch_cycle_result(&bench.cycle)->overtravel_counts);
    TEST_ASSERT_EQUAL_INT32(0, touch_cycle_result(&bench.cycle)->fast_overtravel_counts);
}

void test_the_overtravel_counts_along_a_backward_approach_too(void)
{
    start(backwards(ONE));
    (void)touch_at(START - APPROACH);
    (void)rest_at(START - APPROACH - 400);

    TEST_ASSERT_EQUAL_INT32(400, touch_cycle_result(&bench.cycle)->overtravel_counts);
}

void test_it_is_done_when_it_is_back(void)
{
    start(ONE);
    (void)touch_at(SURFACE);
    (void)rest_at(SURFACE + 400);
    bench_carry_out(&bench);
    TEST_ASSERT_EQUAL(TOUCH_RETURNING, bench_poll(&bench));

    TEST_ASSERT_EQUAL(TOUCH_DONE, release_and_rest_at(START));
    TEST_ASSERT_EQUAL(TOUCH_OK, touch_cycle_result(&bench.cycle)->error);
    bench_check_no_request(&bench);
}

void test_the_result_tells_touch_and_duration(void)
{
    start(ONE);
    (void)touch_at(SURFACE + 9);
    (void)rest_at(SURFACE + 400);
    bench_carry_out(&bench);
    (void)release_and_rest_at(START);
    const touch_result_t *result = touch_cycle_result(&bench.cycle);

    TEST_ASSERT_EQUAL_INT32(SURFACE + 9, result->latch.position_counts);
    TEST_ASSERT_EQUAL_UINT32(101000u, result->latch.ticks);
    TEST_ASSERT_EQUAL_UINT32(100000u + 20000u + 5000u + 20000u, result->duration_ticks);
}

void test_the_duration_counts_across_the_wrap(void)
{
    bench_set_up(&bench, UINT32_MAX - 110000u, START);
    start(ONE);
    (void)touch_at(SURFACE);
    (void)rest_at(SURFACE + 400);
    bench_carry_out(&bench);

    TEST_ASSERT_EQUAL(TOUCH_DONE, release_and_rest_at(START));
    TEST_ASSERT_EQUAL_UINT32(145000u, touch_cycle_result(&bench.cycle)->duration_ticks);
}

void test_a_cycle_that_is_done_stays_so(void)
{
    test_it_is_done_when_it_is_back();
    bench_pass(&bench, 1000000u);

    TEST_ASSERT_EQUAL(TOUCH_DONE, bench_poll(&bench));
    bench_check_no_request(&bench);
    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER, touch_cycle_idle_ticks(&bench.cycle, 0u));
}

void test_a_probe_that_lets_go_before_the_return_is_as_good(void)
{
    start(ONE);
    (void)touch_at(SURFACE);
    bench_release(&bench);
    (void)rest_at(SURFACE + 400);
    bench_carry_out(&bench);

    TEST_ASSERT_EQUAL(TOUCH_DONE, rest_at(START));
}

void test_one_cycle_follows_another(void)
{
    test_it_is_done_when_it_is_back();

    test_it_is_done_when_it_is_back();
}

void test_a_new_cycle_forgets_the_result_of_the_last(void)
{
    latch_record_t record;
    test_it_is_done_when_it_is_back();

    start(ONE);

    TEST_ASSERT_EQUAL_INT32(0, touch_cycle_result(&bench.cycle)->overtravel_counts);
    TEST_ASSERT_FALSE(touch_cycle_take_latch(&bench.cycle, &record));
}

void test_the_configuration_is_copied(void)
{
    touch_config_t config = ONE;
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &config));
    bench_carry_out(&bench);
    config = (touch_config_t){0};
    (void)touch_at(SURFACE);
    bench_check_stop(&bench);
    (void)rest_at(SURFACE + 1);

    bench_check_move(&bench, START, FAST);
}

/* ---- two touches ---- */

static void touch_fast(touch_config_t config, int32_t position_counts)
{
    start(config);
    TEST_ASSERT_EQUAL(TOUCH_STOPPING, touch_at(position_counts));
    bench_check_stop(&bench);
}

/* As far as the beginning of the measuring touch. */
static void touch_and_back_off(void)
{
    touch_fast(TWO, SURFACE + 50);
    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, rest_at(SURFACE + 450));
    bench_check_move(&bench, SURFACE + 50 - BACK_OFF, FAST);
    TEST_ASSERT_EQUAL(TOUCH_MEASURING, release_and_rest_at(SURFACE + 50 - BACK_OFF));
}

void test_the_first_of_two_touches_gives_no_latch(void)
{
    latch_record_t record;
    touch_fast(TWO, SURFACE);

    TEST_ASSERT_FALSE(touch_cycle_take_latch(&bench.cycle, &record));
}

void test_it_backs_off_from_the_latch_not_from_the_standstill(void)
{
    touch_fast(TWO, SURFACE + 50);

    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, rest_at(SURFACE + 450));
    bench_check_move(&bench, SURFACE + 50 - BACK_OFF, FAST);
}

void test_it_backs_off_the_other_way_too(void)
{
    touch_fast(backwards(TWO), START - APPROACH);

    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, rest_at(START - APPROACH - 400));
    bench_check_move(&bench, START - APPROACH + BACK_OFF, FAST);
}

void test_the_second_touch_is_slow_and_looks_as_far_as_the_first(void)
{
    touch_and_back_off();

    bench_check_move(&bench, START + APPROACH + BEYOND, SLOW);
}

void test_the_second_touch_is_the_one_that_counts(void)
{
    latch_record_t record;
    touch_and_back_off();
    bench_carry_out(&bench);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, touch_at(SURFACE + 2));
    bench_check_stop(&bench);
    TEST_ASSERT_TRUE(touch_cycle_take_latch(&bench.cycle, &record));
    TEST_ASSERT_EQUAL_INT32(SURFACE + 2, record.position_counts);
    TEST_ASSERT_EQUAL_UINT32(bench.input.now_ticks, record.ticks);
}

void test_both_overtravels_are_told(void)
{
    touch_and_back_off();
    bench_carry_out(&bench);
    (void)touch_at(SURFACE + 2);
    (void)rest_at(SURFACE + 6);
    const touch_result_t *result = touch_cycle_result(&bench.cycle);

    TEST_ASSERT_EQUAL_INT32(400, result->fast_overtravel_counts);
    TEST_ASSERT_EQUAL_INT32(4, result->overtravel_counts);
}

void test_after_the_second_touch_it_returns_at_the_fast_feed(void)
{
    touch_and_back_off();
    bench_carry_out(&bench);
    (void)touch_at(SURFACE + 2);
    bench_check_stop(&bench);

    TEST_ASSERT_EQUAL(TOUCH_RETURNING, rest_at(SURFACE + 6));
    bench_check_move(&bench, START, FAST);
    TEST_ASSERT_EQUAL(TOUCH_DONE, release_and_rest_at(START));
}

/* ---- debouncing ---- */

void test_the_axis_goes_on_until_the_touch_is_confirmed(void)
{
    touch_config_t config = ONE;
    config.confirm_us = 200u;
    start(config);
    TEST_ASSERT_EQUAL(TOUCH_APPROACHING, touch_at(SURFACE));
    bench_pass(&bench, 199u);
    TEST_ASSERT_EQUAL(TOUCH_APPROACHING, bench_poll(&bench));
    bench_check_no_request(&bench);
    bench_pass(&bench, 1u);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, bench_poll(&bench));
    TEST_ASSERT_EQUAL_INT32(SURFACE, touch_cycle_result(&bench.cycle)->latch.position_counts);
}

void test_a_glitch_on_the_way_is_passed_over(void)
{
    touch_config_t config = ONE;
    config.confirm_us = 200u;
    start(config);
    (void)touch_at(START + 100);
    bench_release(&bench);
    (void)bench_poll(&bench);
    bench_pass(&bench, 200u);
    TEST_ASSERT_EQUAL(TOUCH_APPROACHING, bench_poll(&bench));

    (void)touch_at(SURFACE);
    bench_pass(&bench, 200u);

    TEST_ASSERT_EQUAL(TOUCH_MEASURED, bench_poll(&bench));
    TEST_ASSERT_EQUAL_INT32(SURFACE, touch_cycle_result(&bench.cycle)->latch.position_counts);
}

/* ---- re-triggers ---- */

void test_triggers_while_decelerating_belong_to_the_touch(void)
{
    start(ONE);
    (void)touch_at(SURFACE);
    bench_check_stop(&bench);
    for (int32_t again = 1; again <= 3; ++again) {
        bench_release(&bench);
        (void)bench_poll(&bench);
        bench_pass(&bench, 3000u);
        bench_touch(&bench, SURFACE + 100 * again);

        TEST_ASSERT_EQUAL(TOUCH_MEASURED, bench_poll(&bench));
        bench_check_no_request(&bench);
    }
    TEST_ASSERT_EQUAL_INT32(SURFACE, touch_cycle_result(&bench.cycle)->latch.position_counts);
}

void test_triggers_while_decelerating_are_not_held_against_the_next_cycle(void)
{
    test_triggers_while_decelerating_belong_to_the_touch();
    (void)rest_at(SURFACE + 400);
    bench_carry_out(&bench);
    TEST_ASSERT_EQUAL(TOUCH_DONE, release_and_rest_at(START));
    latch_record_t record;
    TEST_ASSERT_TRUE(touch_cycle_take_latch(&bench.cycle, &record));

    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &ONE));
    bench_carry_out(&bench);
    (void)touch_at(SURFACE);
    TEST_ASSERT_EQUAL_HEX8(0u, touch_cycle_result(&bench.cycle)->latch.flags);
}

void test_a_trigger_while_decelerating_is_not_taken_for_the_second_touch(void)
{
    touch_fast(TWO, SURFACE);
    bench_release(&bench);
    (void)bench_poll(&bench);
    bench_pass(&bench, 3000u);
    bench_touch(&bench, SURFACE + 200);
    TEST_ASSERT_EQUAL(TOUCH_STOPPING, bench_poll(&bench));
    (void)rest_at(SURFACE + 400);
    bench_check_move(&bench, SURFACE - BACK_OFF, FAST);
    (void)release_and_rest_at(SURFACE - BACK_OFF);
    bench_carry_out(&bench);

    TEST_ASSERT_EQUAL(TOUCH_MEASURING, bench_poll(&bench));
    TEST_ASSERT_EQUAL(TOUCH_MEASURED, touch_at(SURFACE + 1));
    TEST_ASSERT_EQUAL_INT32(SURFACE + 1, touch_cycle_result(&bench.cycle)->latch.position_counts);
}
