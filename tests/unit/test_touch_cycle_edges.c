/*
 * An edge at any instant around the arming of the latch, at the start and before the slow touch:
 * refused, or latched, but never lost, so no axis is driven on against a deflected probe.
 */
/* LINK: firmware/cycle/touch_cycle*.c firmware/input/latch.c
 *       tests/support/cycle_bench.c tests/support/fake_critical.c */
/* MOCK: hal/include/hal_clock.h */
#include "cycle_bench.h"
#include "fake_critical.h"
#include "mock_hal_clock.h"
#include "unity.h"

#define SECTIONS_MAX 16u /* more than any call below has */

static cycle_bench_t bench;
static unsigned      sections_before; /* the edge comes after the next section but so many */
static bool          is_edge_due;

/* An interrupt that was masked comes as soon as it can. */
static void come_due(void)
{
    if (is_edge_due && sections_before-- == 0u) {
        is_edge_due = false;
        bench_touch(&bench, bench.input.position_counts);
    }
}

/* The same by a scan, which tells the level at once. */
static void come_due_in_a_scan(void)
{
    if (is_edge_due && sections_before-- == 0u) {
        is_edge_due = false;
        bench_touch(&bench, bench.input.position_counts);
        latch_poll(&bench.latch, bench.input.now_ticks, true);
    }
}

static void (*const SOURCES[])(void) = {come_due, come_due_in_a_scan};
#define SOURCE_COUNT (sizeof SOURCES / sizeof *SOURCES)

void setUp(void)
{
    fake_critical_reset(NULL);
    hal_clock_tick_ps_IgnoreAndReturn(BENCH_TICK_PS);
    is_edge_due = false;
}

void tearDown(void)
{
    fake_critical_verify();
}

static void expect_edge(unsigned sections, void (*source)(void))
{
    fake_critical_reset(source);
    sections_before = sections;
    is_edge_due = true;
}

/* Polls on while the probe stays deflected: whatever moves has to stop. */
static void check_stops(void)
{
    for (unsigned i = 0u; i < 3u; ++i) {
        (void)bench_poll(&bench);
    }
    touch_request_t request = {.kind = TOUCH_STOP};
    (void)touch_cycle_take_request(&bench.cycle, &request);
    TEST_ASSERT_EQUAL(TOUCH_STOP, request.kind);
    TEST_ASSERT_NOT_EQUAL(TOUCH_APPROACHING, bench.cycle.state);
    TEST_ASSERT_NOT_EQUAL(TOUCH_MEASURING, bench.cycle.state);
}

/* ---- the start ---- */

static void check_start(unsigned sections, void (*source)(void))
{
    is_edge_due = false;
    bench_set_up(&bench, 1000u, BENCH_START);
    (void)bench_poll(&bench);
    expect_edge(sections, source);

    touch_error_t error =
        touch_cycle_start(&bench.cycle, &bench.latch, &BENCH_ONE_TOUCH, &bench.input);

    if (is_edge_due) { /* there are fewer sections */
        return;
    }
    if (error == TOUCH_OK) {
        bench_carry_out(&bench);
        check_stops();
    } else {
        TEST_ASSERT_TRUE(error == TOUCH_ERR_UNARMED_TOUCH || error == TOUCH_ERR_DEFLECTED_AT_START);
        bench_check_failed(&bench, error, false);
    }
}

void test_an_edge_during_the_start_is_refused_or_latched(void)
{
    for (size_t source = 0u; source < SOURCE_COUNT; ++source) {
        for (unsigned sections = 0u; sections < SECTIONS_MAX; ++sections) {
            check_start(sections, SOURCES[source]);
        }
    }
}

void test_an_edge_between_poll_and_start_is_told_as_unarmed(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    (void)bench_poll(&bench);
    bench_touch(&bench, BENCH_START);

    TEST_ASSERT_EQUAL(TOUCH_ERR_UNARMED_TOUCH, touch_cycle_start(&bench.cycle, &bench.latch,
                                                                 &BENCH_ONE_TOUCH, &bench.input));
}

/* ---- the slow touch ---- */

/* Backed off and free, one poll before the slow touch begins. */
static void back_off(void)
{
    bench_set_going(&bench, 1000u, &BENCH_TWO_TOUCHES);
    bench_retreat(&bench);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    (void)bench_poll(&bench);
    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, bench.cycle.state);
    bench.input.position_counts = BENCH_SURFACE - BENCH_BACK_OFF;
    bench.input.is_moving = false;
}

static void check_slow_touch(unsigned sections, void (*source)(void))
{
    is_edge_due = false;
    back_off();
    latch_poll(&bench.latch, bench.input.now_ticks, false);
    expect_edge(sections, source);

    (void)touch_cycle_poll(&bench.cycle, &bench.input);

    if (is_edge_due) {
        return;
    }
    bench_carry_out(&bench);
    check_stops();
}

void test_an_edge_while_the_slow_touch_begins_is_refused_or_latched(void)
{
    for (size_t source = 0u; source < SOURCE_COUNT; ++source) {
        for (unsigned sections = 0u; sections < SECTIONS_MAX; ++sections) {
            check_slow_touch(sections, SOURCES[source]);
        }
    }
}

/* An edge that the poll has not seen holds the slow touch back until the next one. */
static void hold_back(void)
{
    back_off();
    latch_poll(&bench.latch, bench.input.now_ticks, false);
    bench_touch(&bench, BENCH_SURFACE - BENCH_BACK_OFF);
    TEST_ASSERT_EQUAL(TOUCH_BACKING_OFF, touch_cycle_poll(&bench.cycle, &bench.input));
    bench_check_no_request(&bench);
}

void test_a_glitch_before_the_slow_touch_costs_one_poll(void)
{
    hold_back();
    TEST_ASSERT_EQUAL_UINT32(0u, touch_cycle_idle_ticks(&bench.cycle, bench.input.now_ticks));
    bench_release(&bench);

    TEST_ASSERT_EQUAL(TOUCH_MEASURING, bench_poll(&bench));
    bench_check_move(&bench, BENCH_END, BENCH_SLOW);
}

void test_a_touch_before_the_slow_touch_ends_the_cycle(void)
{
    hold_back();

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
    bench_check_failed(&bench, TOUCH_ERR_DEFLECTED_IN_RETREAT, true);
}
