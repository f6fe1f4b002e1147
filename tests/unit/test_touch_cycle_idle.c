/*
 * How long polling may be left out: a cycle polled only when something happens, and when its own
 * word says, does to the tick what one does that is polled at every tick.
 */
/* LINK: firmware/cycle/touch_cycle*.c firmware/input/latch.c
 *       tests/support/cycle_bench.c tests/support/fake_critical.c */
/* MOCK: hal/include/hal_clock.h */
#include "cycle_bench.h"
#include "fake_critical.h"
#include "input/ticks.h"
#include "mock_hal_clock.h"
#include "unity.h"

#define SURFACE 5000
#define TIMEOUT 60u
#define SETTLE  25u
#define HOLDOFF 15u
#define CONFIRM 6u
#define LENGTH  400u /* ticks of a script */

/* The cycle's own slips show on the host; in an emulator, a hundred times slower, few scripts show
 * those of the board's compiler. */
#ifdef SUPPORT_TARGET_H
#define SCRIPTS 100u
#else
#define SCRIPTS 3000u
#endif

static const touch_config_t ONE = {.approach_counts = SURFACE,
                                   .overtravel_counts = 2000,
                                   .feed_mm_min = 3000.0,
                                   .timeout_us = TIMEOUT,
                                   .settle_us = SETTLE,
                                   .holdoff_us = HOLDOFF};

static cycle_bench_t bench;
static uint32_t      seed;

void setUp(void)
{
    fake_critical_reset(NULL);
    hal_clock_tick_ps_IgnoreAndReturn(BENCH_TICK_PS);
    bench_set_up(&bench, 1000u, 0);
}

void tearDown(void)
{
    fake_critical_verify();
}

static uint32_t idle(void)
{
    return touch_cycle_idle_ticks(&bench.cycle, bench.input.now_ticks);
}

static void start(const touch_config_t *config)
{
    (void)bench_start(&bench, config);
    bench_carry_out(&bench);
}

static void touch(void)
{
    bench_touch(&bench, SURFACE);
    (void)bench_poll(&bench);
    bench_carry_out(&bench);
}

static void retreat(void)
{
    touch();
    (void)bench_rest(&bench, SURFACE + 100);
    bench_carry_out(&bench);
    (void)bench_poll(&bench);
}

void test_a_moving_axis_is_left_alone_until_its_timeout(void)
{
    start(&ONE);
    TEST_ASSERT_EQUAL_UINT32(TIMEOUT, idle());
    bench_pass(&bench, 10u);

    TEST_ASSERT_EQUAL_UINT32(TIMEOUT - 10u, idle());
}

void test_an_edge_that_waits_is_polled_when_it_can_be_confirmed(void)
{
    touch_config_t config = ONE;
    config.confirm_us = CONFIRM;
    start(&config);
    touch();
    bench_pass(&bench, 2u);

    TEST_ASSERT_EQUAL_UINT32(CONFIRM - 2u, idle());
}

void test_a_timeout_before_the_confirmation_comes_first(void)
{
    touch_config_t config = ONE;
    config.confirm_us = CONFIRM;
    start(&config);
    bench_pass(&bench, TIMEOUT - 2u);
    touch();

    TEST_ASSERT_EQUAL_UINT32(2u, idle());
}

void test_a_stuck_probe_is_polled_when_it_has_to_be_given_up(void)
{
    start(&ONE);
    retreat();
    (void)bench_rest(&bench, 0);
    bench_pass(&bench, 5u);

    TEST_ASSERT_EQUAL_UINT32(SETTLE - 5u, idle());
}

void test_a_probe_deflected_again_is_polled_when_its_hold_off_is_over(void)
{
    start(&ONE);
    retreat();
    bench_release(&bench);
    (void)bench_poll(&bench);
    bench_pass(&bench, 5u);
    bench.is_deflected = true;
    (void)bench_poll(&bench);

    TEST_ASSERT_LESS_OR_EQUAL_UINT32(HOLDOFF - 5u, idle());
}

/* Once the probe is free, the settling time is of no account any more. */
void test_a_free_probe_at_rest_is_polled_when_its_hold_off_is_over(void)
{
    touch_config_t config = ONE;
    config.settle_us = 0u;
    start(&config);
    retreat();
    bench_release(&bench);
    (void)bench_poll(&bench);
    bench_pass(&bench, 5u);
    (void)bench_rest(&bench, 0);

    TEST_ASSERT_EQUAL_UINT32(HOLDOFF - 5u, idle());
}

void test_a_cycle_that_is_over_needs_no_polling(void)
{
    start(&ONE);
    (void)bench_rest(&bench, SURFACE + 2000);

    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER, idle());
}

/* ---- random scripts ---- */

static uint32_t draw(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)seed * below >> 32);
}

/* What happens at this tick, the same to both benches; false if nothing does. */
typedef enum { NOTHING, TOUCH, RELEASE, REST } happening_t;

static happening_t draw_happening(void)
{
    static const happening_t wheel[] = {TOUCH, TOUCH, RELEASE, RELEASE, RELEASE, REST};
    return draw(5u) == 0u ? wheel[draw(6u)] : NOTHING;
}

static bool happen(cycle_bench_t *desk, happening_t what)
{
    if (what == TOUCH && !desk->is_deflected) {
        bench_touch(desk, (int32_t)draw(2u * SURFACE));
        return true;
    }
    if (what == RELEASE && desk->is_deflected) {
        bench_release(desk);
        return true;
    }
    if (what == REST && desk->input.is_moving) {
        desk->input.is_moving = false;
        return true;
    }
    return false;
}

/* One poll and what it asks for; a stop may find the axis at rest at once. */
static touch_request_t poll(cycle_bench_t *desk)
{
    touch_request_t request = {TOUCH_STOP, -1, 0.0};
    (void)bench_poll(desk);
    if (touch_cycle_take_request(&desk->cycle, &request) && request.kind == TOUCH_MOVE) {
        desk->input.is_moving = true;
    }
    return request;
}

static void check_alike(const cycle_bench_t *polled, const cycle_bench_t *idle_bench)
{
    const touch_result_t *a = touch_cycle_result(&polled->cycle);
    const touch_result_t *b = touch_cycle_result(&idle_bench->cycle);
    TEST_ASSERT_EQUAL_MESSAGE(polled->cycle.state, idle_bench->cycle.state, "state");
    TEST_ASSERT_EQUAL_MESSAGE(a->error, b->error, "error");
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(a->latch.ticks, b->latch.ticks, "latch");
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(a->duration_ticks, b->duration_ticks, "duration");
    TEST_ASSERT_EQUAL_MESSAGE(polled->input.is_moving, idle_bench->input.is_moving, "motion");
}

static touch_config_t draw_config(void)
{
    touch_config_t config = ONE;
    config.two_touches = draw(2u) != 0u;
    config.back_off_counts = 300;
    config.measure_feed_mm_min = 30.0;
    config.timeout_us = draw(3u) * TIMEOUT;
    config.confirm_us = draw(2u) * CONFIRM;
    config.holdoff_us = draw(2u) * HOLDOFF;
    return config;
}

/* The same to both desks; `due` is when the second has to be polled by its own word. */
static void run_script(cycle_bench_t *polled, cycle_bench_t *lazy)
{
    uint32_t due = 0u;
    for (uint32_t tick = 0u; tick < LENGTH; ++tick) {
        happening_t what = draw_happening();
        uint32_t    before = seed;
        bool        happened = happen(polled, what);
        seed = before;
        (void)happen(lazy, what);
        touch_request_t asked = poll(polled);
        if (happened || due == 0u) {
            TEST_ASSERT_EQUAL_INT32(asked.target_counts, poll(lazy).target_counts);
            due = touch_cycle_idle_ticks(&lazy->cycle, lazy->input.now_ticks);
        }
        check_alike(polled, lazy);
        due -= due == 0u || due == TICKS_NEVER ? 0u : 1u;
        bench_pass(polled, 1u);
        bench_pass(lazy, 1u);
    }
}

void test_leaving_out_idle_polls_changes_nothing(void)
{
    static cycle_bench_t lazy;
    for (uint32_t script = 0u; script < SCRIPTS; ++script) {
        seed = script;
        touch_config_t config = draw_config();
        bench_set_up(&bench, 0xFFFFFF00u, 0);
        (void)bench_start(&bench, &config);
        bench_carry_out(&bench);
        lazy = bench;
        lazy.cycle.latch = &lazy.latch;

        run_script(&bench, &lazy);
    }
}
