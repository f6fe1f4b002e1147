#include "cycle_bench.h"

#include "unity.h"

const touch_config_t BENCH_ONE_TOUCH = {.approach_counts = BENCH_APPROACH,
                                        .overtravel_counts = BENCH_BEYOND,
                                        .feed_mm_min = BENCH_FAST,
                                        .timeout_us = BENCH_TIMEOUT,
                                        .settle_us = BENCH_SETTLE,
                                        .holdoff_us = BENCH_HOLDOFF};

const touch_config_t BENCH_TWO_TOUCHES = {.two_touches = true,
                                          .approach_counts = BENCH_APPROACH,
                                          .overtravel_counts = BENCH_BEYOND,
                                          .back_off_counts = BENCH_BACK_OFF,
                                          .feed_mm_min = BENCH_FAST,
                                          .measure_feed_mm_min = BENCH_SLOW,
                                          .timeout_us = BENCH_TIMEOUT,
                                          .settle_us = BENCH_SETTLE,
                                          .holdoff_us = BENCH_HOLDOFF};

void bench_set_up(cycle_bench_t *bench, uint32_t now_ticks, int32_t position_counts)
{
    *bench = (cycle_bench_t){
        .input = {.now_ticks = now_ticks, .position_counts = position_counts},
    };
    latch_init(&bench->latch, 0u, 0u);
}

void bench_set_going(cycle_bench_t *bench, uint32_t now_ticks, const touch_config_t *config)
{
    bench_set_up(bench, now_ticks, BENCH_START);
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(bench, config));
    bench_carry_out(bench);
}

touch_error_t bench_start(cycle_bench_t *bench, const touch_config_t *config)
{
    latch_poll(&bench->latch, bench->input.now_ticks, bench->is_deflected);
    return touch_cycle_start(&bench->cycle, &bench->latch, config, &bench->input);
}

touch_state_t bench_poll(cycle_bench_t *bench)
{
    latch_poll(&bench->latch, bench->input.now_ticks, bench->is_deflected);
    return touch_cycle_poll(&bench->cycle, &bench->input);
}

void bench_pass(cycle_bench_t *bench, uint32_t ticks)
{
    bench->input.now_ticks += ticks;
}

void bench_touch(cycle_bench_t *bench, int32_t position_counts)
{
    bench->input.position_counts = position_counts;
    bench->is_deflected = true;
    latch_on_edge(&bench->latch, bench->input.now_ticks, position_counts);
}

void bench_release(cycle_bench_t *bench)
{
    bench->is_deflected = false;
}

void bench_release_and_poll(cycle_bench_t *bench)
{
    bench_release(bench);
    (void)bench_poll(bench);
}

touch_state_t bench_rest(cycle_bench_t *bench, int32_t position_counts)
{
    bench->input.position_counts = position_counts;
    bench->input.is_moving = false;
    return bench_poll(bench);
}

static touch_request_t take_request(cycle_bench_t *bench)
{
    touch_request_t request = {TOUCH_STOP, 0, 0.0};
    TEST_ASSERT_TRUE_MESSAGE(touch_cycle_take_request(&bench->cycle, &request),
                             "nothing asked for");
    return request;
}

void bench_check_move(cycle_bench_t *bench, int32_t target_counts, double feed_mm_min)
{
    touch_request_t request = take_request(bench);
    TEST_ASSERT_EQUAL_MESSAGE(TOUCH_MOVE, request.kind, "a move");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(target_counts, request.target_counts, "target");
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(feed_mm_min, request.feed_mm_min, "feed");
    bench_check_no_request(bench);
    bench->input.is_moving = true;
}

void bench_check_stop(cycle_bench_t *bench)
{
    TEST_ASSERT_EQUAL_MESSAGE(TOUCH_STOP, take_request(bench).kind, "a stop");
    bench_check_no_request(bench);
}

void bench_check_no_request(cycle_bench_t *bench)
{
    touch_request_t request;
    TEST_ASSERT_FALSE_MESSAGE(touch_cycle_take_request(&bench->cycle, &request),
                              "a motion nobody wanted");
}

void bench_check_failed(cycle_bench_t *bench, touch_error_t error, bool stops)
{
    TEST_ASSERT_EQUAL_MESSAGE(TOUCH_FAILED, bench->cycle.state, "state");
    TEST_ASSERT_EQUAL_MESSAGE(error, touch_cycle_result(&bench->cycle)->error, "error");
    if (stops) {
        bench_check_stop(bench);
    } else {
        bench_check_no_request(bench);
    }
}

void bench_carry_out(cycle_bench_t *bench)
{
    touch_request_t request;
    if (touch_cycle_take_request(&bench->cycle, &request) && request.kind == TOUCH_MOVE) {
        bench->input.is_moving = true;
    }
}

void bench_touch_surface(cycle_bench_t *bench)
{
    bench_pass(bench, 100u);
    bench_touch(bench, BENCH_SURFACE);
    (void)bench_poll(bench);
    bench_carry_out(bench);
}

void bench_retreat(cycle_bench_t *bench)
{
    bench_touch_surface(bench);
    bench_pass(bench, 100u);
    (void)bench_rest(bench, BENCH_SURFACE + 100);
    bench_carry_out(bench);
    (void)bench_poll(bench);
    bench_pass(bench, BENCH_UNDER_WAY);
    (void)bench_poll(bench);
}
