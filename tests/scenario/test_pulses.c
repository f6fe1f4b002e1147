/*
 * Contacts that do not stay closed: glitches against the filter, pulses against the scan, pulses
 * against the confirmation.
 */
/* LINK: tests/support/play.c tests/support/dice.c $(OUT)/libskiplatch_sim.a */
#include <math.h>

#include "api/rig.h"
#include "dice.h"
#include "play.h"
#include "unity.h"

#define SCAN_US     4000.0
#define FILTER_US   50.0
#define TOUCHES     4000u /* a touch each µs of a scan */
#define GAP_S       3.0
#define RANDOM_MAX  20000u
#define FALSE_ALARM 5.0 /* standard deviations: less than 1e-6 on both sides together */

static sim_chain_t      chain;
static sim_controller_t controller;
static sim_touch_t      touches[RANDOM_MAX];
static sim_outcome_t    outcomes[RANDOM_MAX];

void setUp(void)
{
    chain = PLAY_BENCH;
    chain.scan_us = SCAN_US;
    controller = PLAY_ONE_TOUCH;
    controller.overtravel_mm = 0.5;
}

void tearDown(void)
{
}

static void fill(int32_t path, double pulse_us, unsigned n)
{
    for (unsigned i = 0u; i < n; ++i) {
        touches[i] = play_touch(i, path, GAP_S * i + 1e-6 * i);
        touches[i].pulse_us = pulse_us;
    }
}

static unsigned play_and_count(unsigned n)
{
    unsigned seen = 0u;
    play(&chain, &controller, touches, n, outcomes);
    for (unsigned i = 0u; i < n; ++i) {
        TEST_ASSERT_EQUAL_INT32(outcomes[i].status == SIM_STATUS_OK ? TOUCH_OK : TOUCH_ERR_NO_TOUCH,
                                outcomes[i].error);
        seen += outcomes[i].status == SIM_STATUS_OK ? 1u : 0u;
    }
    return seen;
}

static unsigned seen_of_scan(int32_t path, double pulse_us)
{
    fill(path, pulse_us, TOUCHES);
    return play_and_count(TOUCHES);
}

/* ---- the filter ---- */

void test_a_glitch_shorter_than_the_filter_is_never_latched(void)
{
    chain.filter_us = FILTER_US;
    for (double pulse_us = 0.001; pulse_us < FILTER_US; pulse_us = pulse_us * 3.0 + 0.001) {
        TEST_ASSERT_EQUAL_UINT(0u, seen_of_scan(SIM_PATH_SKIP, pulse_us));
        TEST_ASSERT_EQUAL_UINT(0u, seen_of_scan(SIM_PATH_PLC, pulse_us));
    }
    TEST_ASSERT_EQUAL_UINT(0u, seen_of_scan(SIM_PATH_SKIP, FILTER_US - 0.001));
    TEST_ASSERT_EQUAL_UINT(0u, seen_of_scan(SIM_PATH_PLC, FILTER_US - 0.001));
}

void test_a_pulse_longer_than_the_filter_is_always_latched_by_the_skip_input(void)
{
    chain.filter_us = FILTER_US;

    TEST_ASSERT_EQUAL_UINT(TOUCHES, seen_of_scan(SIM_PATH_SKIP, FILTER_US + 0.001));
}

void test_without_a_filter_the_shortest_pulse_is_latched_by_the_skip_input(void)
{
    TEST_ASSERT_EQUAL_UINT(TOUCHES, seen_of_scan(SIM_PATH_SKIP, 0.001));
}

void test_a_filter_delays_the_latch_by_itself(void)
{
    sim_outcome_t plain;
    touches[0] = play_touch(0u, SIM_PATH_SKIP, 1.0);
    play(&chain, &controller, touches, 1u, &plain);
    chain.filter_us = FILTER_US;
    play(&chain, &controller, touches, 1u, outcomes);

    TEST_ASSERT_EQUAL_INT64(play_ns(plain.latch_us + FILTER_US), play_ns(outcomes[0].latch_us));
}

/* ---- the scan ---- */

void test_the_plc_sees_a_pulse_as_often_as_it_covers_a_scan(void)
{
    static const double pulses_us[] = {1.0, 2.0, 500.0, 2000.0, 3999.0};
    for (size_t i = 0u; i < sizeof pulses_us / sizeof *pulses_us; ++i) {
        TEST_ASSERT_EQUAL_UINT((unsigned)pulses_us[i], seen_of_scan(SIM_PATH_PLC, pulses_us[i]));
    }
}

void test_the_plc_always_sees_a_pulse_of_a_scan(void)
{
    TEST_ASSERT_EQUAL_UINT(TOUCHES, seen_of_scan(SIM_PATH_PLC, SCAN_US));
    TEST_ASSERT_EQUAL_UINT(TOUCHES, seen_of_scan(SIM_PATH_PLC, 1.5 * SCAN_US));
}

void test_a_pulse_that_covers_no_scan_is_never_seen(void)
{
    TEST_ASSERT_EQUAL_UINT(TOUCHES, seen_of_scan(SIM_PATH_PLC, 0.0)); /* no pulse: it stays */
    double first_us = outcomes[0].latch_us;
    for (unsigned i = 0u; i < TOUCHES; ++i) {
        double edge_us = outcomes[i].true_edge_us;
        double to_scan_us = fmod(first_us - edge_us, SCAN_US);
        to_scan_us += to_scan_us < 0.0 ? SCAN_US : 0.0;
        touches[i].pulse_us = fmax(0.001, to_scan_us - 0.002);
        touches[i].path = to_scan_us > 0.01 ? SIM_PATH_PLC : SIM_PATH_SKIP;
    }
    unsigned seen = play_and_count(TOUCHES);

    TEST_ASSERT_LESS_OR_EQUAL_UINT(1u,
                                   seen); /* the one at the scan itself, which was left to skip */
}

void test_an_image_of_any_age_keeps_a_pulse_that_a_scan_has_seen(void)
{
    for (int32_t delay = 0; delay <= 7; ++delay) {
        controller.image_delay_scans = delay;
        TEST_ASSERT_EQUAL_UINT(1000u, seen_of_scan(SIM_PATH_PLC, 1000.0));
    }
}

void test_random_pulses_are_seen_in_proportion_to_their_length(void)
{
    dice_t dice = dice_seed(7u);
    for (double pulse_us = 100.0; pulse_us < SCAN_US; pulse_us *= 2.0) {
        fill(SIM_PATH_PLC, pulse_us, RANDOM_MAX);
        for (unsigned i = 0u; i < RANDOM_MAX; ++i) {
            touches[i].time_s += dice_between(&dice, 0.0, 0.1);
        }
        double seen = play_and_count(RANDOM_MAX);

        double share = pulse_us / SCAN_US;
        double sigma = sqrt(RANDOM_MAX * share * (1.0 - share));
        TEST_ASSERT_DOUBLE_WITHIN(FALSE_ALARM * sigma, RANDOM_MAX * share, seen);
    }
}

/* ---- the confirmation ---- */

void test_the_skip_input_rejects_a_pulse_shorter_than_the_confirmation(void)
{
    controller.confirm_us = 300.0;
    TEST_ASSERT_EQUAL_UINT(0u, seen_of_scan(SIM_PATH_SKIP, 299.0));
}

void test_the_skip_input_confirms_a_pulse_longer_than_the_confirmation(void)
{
    controller.confirm_us = 300.0;
    TEST_ASSERT_EQUAL_UINT(TOUCHES, seen_of_scan(SIM_PATH_SKIP, 303.0));
}

void test_a_rejected_pulse_is_counted_as_a_glitch(void)
{
    static rig_t rig;
    controller.confirm_us = 300.0;
    rig_boot(&rig, &chain, &controller, NULL, 0u, PLAY_SEED, 0u, 0);
    touches[0] = play_touch(0u, SIM_PATH_SKIP, 1.0);
    touches[0].pulse_us = 200.0;
    TEST_ASSERT_EQUAL_INT(0, rig_play(&rig, &touches[0], outcomes));

    TEST_ASSERT_EQUAL_UINT16(1u, latch_counters(&rig.skip.latch).glitches);
    TEST_ASSERT_EQUAL_INT32(TOUCH_ERR_NO_TOUCH, outcomes[0].error);
}
