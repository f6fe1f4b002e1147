/*
 * The device clock wraps in the middle of a campaign: at a tick of 0.25 µs after 1073.741824 s.
 * Touches right before, at and after that instant are as good as any.
 */
/* LINK: tests/support/play.c tests/support/dice.c $(OUT)/libskiplatch_sim.a */
#include <math.h>

#include "dice.h"
#include "play.h"
#include "unity.h"

#define TICK_NS     250
#define WRAP_NS     (4294967296ll * TICK_NS)
#define WRAP_S      (WRAP_NS * 1e-9)
#define SCAN_NS     4000000ll
#define LATENCY_NS  2000
#define EARLIER_S   500.0 /* whole scans and whole ticks, and as far from any wrap as can be */
#define TOUCHES_MAX 40000u

static sim_chain_t   chain;
static sim_touch_t   touches[TOUCHES_MAX];
static sim_outcome_t outcomes[TOUCHES_MAX];
static sim_outcome_t earlier[TOUCHES_MAX];

void setUp(void)
{
    chain = PLAY_BENCH;
    chain.tick_us = TICK_NS / 1000.0;
}

void tearDown(void)
{
}

/* From the start of a move to its edge. */
static int64_t way_ns(void)
{
    touches[0] = play_touch(0u, SIM_PATH_SKIP, 1.0);
    play(&chain, &PLAY_ONE_TOUCH, touches, 1u, outcomes);
    return play_ns(outcomes[0].true_edge_us) - 1000000000ll;
}

/* Touches whose edges are a tick apart, the middle one exactly at the wrap. */
static void fill_around_wrap(int32_t path, unsigned n)
{
    int64_t way = way_ns();
    for (unsigned i = 0u; i < n; ++i) {
        int64_t edge_ns = WRAP_NS + ((int64_t)i - n / 2) * TICK_NS;
        touches[i] = play_touch(i, path, (double)(edge_ns - way) * 1e-9);
    }
}

void test_the_skip_input_stamps_tick_by_tick_across_the_wrap(void)
{
    const unsigned n = 20000u;
    fill_around_wrap(SIM_PATH_SKIP, n);
    play(&chain, &PLAY_ONE_TOUCH, touches, n, outcomes);
    play_check_ok(outcomes, n);

    for (unsigned i = 0u; i < n; ++i) {
        int64_t expected_ns = WRAP_NS + ((int64_t)i - n / 2) * TICK_NS + LATENCY_NS;
        TEST_ASSERT_EQUAL_INT64(expected_ns, play_ns(outcomes[i].latch_us));
    }
}

void test_the_plc_stamps_scan_by_scan_across_the_wrap(void)
{
    fill_around_wrap(SIM_PATH_PLC, TOUCHES_MAX);
    play(&chain, &PLAY_ONE_TOUCH, touches, TOUCHES_MAX, outcomes);
    play_check_ok(outcomes, TOUCHES_MAX);

    int64_t first_ns = play_ns(outcomes[0].latch_us);
    for (unsigned i = 0u; i < TOUCHES_MAX; ++i) {
        int64_t latch_ns = play_ns(outcomes[i].latch_us);
        int64_t latency_ns = latch_ns - play_ns(outcomes[i].true_edge_us);
        TEST_ASSERT_EQUAL_INT64(0, (latch_ns - first_ns) % SCAN_NS);
        TEST_ASSERT_GREATER_THAN_INT64(-TICK_NS, latency_ns);
        TEST_ASSERT_LESS_THAN_INT64(SCAN_NS, latency_ns);
    }
    TEST_ASSERT_LESS_THAN_INT64(WRAP_NS, first_ns);
    TEST_ASSERT_GREATER_THAN_INT64(WRAP_NS, play_ns(outcomes[TOUCHES_MAX - 1u].latch_us));
}

/* ---- the same campaign far away from the wrap ---- */

static sim_controller_t draw_controller(dice_t *dice)
{
    return (sim_controller_t){
        .overtravel_mm = 5.0,
        .back_off_mm = 0.25,
        .fast_feed_mm_min = 3000.0,
        .reaction_us = dice_between(dice, 0.0, 5000.0),
        .confirm_us = dice_below(dice, 2u) * dice_between(dice, 0.0, 20000.0),
        .holdoff_us = dice_below(dice, 2u) * dice_between(dice, 0.0, 20000.0),
        .settle_us = 20000.0,
        .two_touches = (int32_t)dice_below(dice, 2u),
        .image_delay_scans = (int32_t)dice_below(dice, 8u),
    };
}

static void check_same_but_for(double later_us, const sim_outcome_t *was, const sim_outcome_t *is)
{
    TEST_ASSERT_EQUAL_INT32(was->error, is->error);
    TEST_ASSERT_EQUAL_INT32(was->status, is->status);
    TEST_ASSERT_EQUAL_INT64(play_ns(was->cycle_s * 1e6), play_ns(is->cycle_s * 1e6));
    if (was->status == SIM_STATUS_OK) {
        TEST_ASSERT_EQUAL_INT64(play_ns(was->latch_us + later_us), play_ns(is->latch_us));
        TEST_ASSERT_EQUAL_INT64(play_ns(was->report_us + later_us), play_ns(is->report_us));
        TEST_ASSERT_EQUAL_DOUBLE(was->deviation_um, is->deviation_um);
        TEST_ASSERT_EQUAL_DOUBLE(was->overtravel_um, is->overtravel_um);
    }
}

/* Cycles of every kind that begin before the wrap and end after it. */
static void check_wrap_changes_nothing(uint64_t seed)
{
    const unsigned   n = 200u;
    dice_t           dice = dice_seed(seed);
    sim_controller_t controller = draw_controller(&dice);
    chain.skip_jitter_us = 1.0;
    chain.report_jitter_us = 50.0;
    for (unsigned i = 0u; i < n; ++i) {
        double back_s = dice_between(&dice, 0.0, 0.6);
        double whole_us = rint((WRAP_S - back_s) * 1e6);
        touches[i] = play_touch(i, (int32_t)dice_below(&dice, 2u), whole_us * 1e-6);
        touches[i].pulse_us = dice_below(&dice, 3u) == 0u ? dice_between(&dice, 1.0, 30000.0) : 0.0;
    }
    play(&chain, &controller, touches, n, outcomes);
    for (unsigned i = 0u; i < n; ++i) {
        touches[i].time_s = rint((touches[i].time_s - EARLIER_S) * 1e6) * 1e-6;
    }
    play(&chain, &controller, touches, n, earlier);

    for (unsigned i = 0u; i < n; ++i) {
        check_same_but_for(EARLIER_S * 1e6, &earlier[i], &outcomes[i]);
    }
}

void test_cycles_across_the_wrap_are_those_of_500_s_before(void)
{
    for (uint64_t seed = 0u; seed < 50u; ++seed) {
        check_wrap_changes_nothing(seed);
    }
}

/* 1 ns ticks wrap every 4.29 s: a long campaign comes round many times, and no touch is misdated.
 */
void test_a_clock_that_wraps_many_times_loses_no_time(void)
{
    const unsigned n = 2000u;
    chain.tick_us = 0.001;
    for (unsigned i = 0u; i < n; ++i) {
        touches[i] = play_touch(i, SIM_PATH_SKIP, 0.7 * i);
    }
    play(&chain, &PLAY_ONE_TOUCH, touches, n, outcomes);
    play_check_ok(outcomes, n);

    for (unsigned i = 0u; i < n; ++i) {
        TEST_ASSERT_EQUAL_INT64(play_ns(outcomes[i].true_edge_us) + LATENCY_NS,
                                play_ns(outcomes[i].latch_us));
    }
}
