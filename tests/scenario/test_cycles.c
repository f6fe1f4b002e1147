/* Whole cycles: how far the axis goes on, how long it all takes, at which feed that is safe. */
/* LINK: tests/support/play.c tests/support/dice.c $(OUT)/libskiplatch_sim.a */
#include <math.h>

#include "api/rig.h"
#include "cycle/overtravel.h"
#include "dice.h"
#include "play.h"
#include "unity.h"

#define UM_PER_MM 1000.0

static sim_chain_t      chain;
static sim_controller_t controller;
static sim_touch_t      touch;
static sim_outcome_t    outcome;

void setUp(void)
{
    chain = PLAY_BENCH;
    controller = PLAY_ONE_TOUCH;
    touch = play_touch(0u, SIM_PATH_SKIP, 1.0);
}

void tearDown(void)
{
}

static void play_one(void)
{
    play(&chain, &controller, &touch, 1u, &outcome);
}

static void play_one_well(void)
{
    play_one();
    play_check_ok(&outcome, 1u);
}

/* ---- overtravel ---- */

static double expected_overtravel_um(double feed_mm_min)
{
    double speed_um_us = feed_mm_min / 60e3;
    double accel_um_us2 = chain.accel_mm_s2 * 1e-9;
    return speed_um_us * controller.reaction_us + speed_um_us * speed_um_us / (2.0 * accel_um_us2);
}

void test_the_axis_goes_on_for_reaction_and_deceleration(void)
{
    dice_t dice = dice_seed(1u);
    for (unsigned i = 0u; i < 1000u; ++i) {
        touch.path = (int32_t)dice_below(&dice, 2u);
        touch.feed_mm_min = dice_any_scale(&dice, 1.0, 4000.0);
        touch.approach_mm = 5.0;
        controller.overtravel_mm = 20.0;
        controller.reaction_us = dice_below(&dice, 2u) * dice_any_scale(&dice, 1.0, 30000.0);
        chain.accel_mm_s2 = dice_any_scale(&dice, 500.0, 20000.0);
        play_one_well();

        TEST_ASSERT_DOUBLE_WITHIN(1.01 * chain.resolution_um,
                                  expected_overtravel_um(touch.feed_mm_min), outcome.overtravel_um);
    }
}

void test_the_formula_of_the_firmware_foretells_it(void)
{
    for (double feed = 10.0; feed < 4000.0; feed *= 1.7) {
        overtravel_path_t path = {controller.reaction_us, chain.accel_mm_s2};
        touch.feed_mm_min = feed;
        play_one_well();

        TEST_ASSERT_DOUBLE_WITHIN(1.01 * chain.resolution_um, overtravel_um(&path, feed),
                                  outcome.overtravel_um);
    }
}

void test_at_the_safe_feed_the_axis_just_stays_within_bounds(void)
{
    for (double allowed_um = 5.0; allowed_um < 2000.0; allowed_um *= 1.5) {
        overtravel_path_t path = {controller.reaction_us, chain.accel_mm_s2};
        touch.approach_mm = 5.0;
        touch.feed_mm_min = overtravel_safe_feed_mm_min(&path, allowed_um);
        play_one_well();
        TEST_ASSERT_DOUBLE_WITHIN(1.01 * chain.resolution_um, allowed_um, outcome.overtravel_um);

        touch.feed_mm_min *= 1.01;
        play_one_well();
        TEST_ASSERT_TRUE(outcome.overtravel_um > allowed_um);
    }
}

/* The latch knows the first edge; that it was confirmed later costs way, not accuracy. */
void test_confirming_costs_overtravel_and_no_accuracy(void)
{
    play_one_well();
    sim_outcome_t at_once = outcome;
    controller.confirm_us = 2000.0;
    play_one_well();

    TEST_ASSERT_EQUAL_DOUBLE(at_once.deviation_um, outcome.deviation_um);
    TEST_ASSERT_EQUAL_DOUBLE(at_once.latch_us, outcome.latch_us);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, at_once.overtravel_um + 2000.0 * 0.01, outcome.overtravel_um);
}

/* ---- how long it takes: the worked example of the reference document ---- */

#define STAND_OFF_MM 5.0
#define FAST         3000.0
#define SLOW         30.0
#define BACK_OFF_MM  0.0849

static double move_s(double way_mm, double feed_mm_min)
{
    double speed = feed_mm_min / 60.0;
    double accel = chain.accel_mm_s2;
    return way_mm >= speed * speed / accel ? way_mm / speed + speed / accel
                                           : 2.0 * sqrt(way_mm / accel);
}

static void set_up_seed_example(void)
{
    chain.skip_latency_us = 0.0;
    touch.approach_mm = STAND_OFF_MM;
    touch.feed_mm_min = FAST;
    controller.reaction_us = 2000.0;
    controller.back_off_mm = BACK_OFF_MM;
    controller.fast_feed_mm_min = FAST;
}

void test_one_touch_takes_254_ms(void)
{
    set_up_seed_example();
    play_one_well();

    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.254, outcome.cycle_s);
}

void test_two_touches_take_444_ms(void)
{
    set_up_seed_example();
    touch.feed_mm_min = SLOW;
    controller.two_touches = 1;
    play_one_well();

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.444, outcome.cycle_s);
}

void test_every_part_of_two_touches_takes_its_time(void)
{
    set_up_seed_example();
    controller.two_touches = 1;
    touch.feed_mm_min = SLOW;
    for (double back_off_mm = 0.02; back_off_mm < 2.0; back_off_mm *= 1.9) {
        double a = chain.accel_mm_s2;
        double v = FAST / 60.0;
        double u = SLOW / 60.0;
        double l = controller.reaction_us * 1e-6;
        double fast_over_mm = v * l + v * v / (2.0 * a);
        double slow_over_mm = u * l + u * u / (2.0 * a);
        controller.back_off_mm = back_off_mm;
        play_one_well();

        double expected_s = STAND_OFF_MM / v + v / (2.0 * a) + l + v / a +
                            move_s(fast_over_mm + back_off_mm, FAST) + back_off_mm / u +
                            u / (2.0 * a) + l + u / a + move_s(STAND_OFF_MM + slow_over_mm, FAST);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, expected_s, outcome.cycle_s);
    }
}

/* From the start to the release on the way back: one touch of the simplest rig, 1 mm at 10 mm/s. */
static double release_s(void)
{
    double v = touch.feed_mm_min / 60.0;
    double ramp_mm = v * v / (2.0 * chain.accel_mm_s2);
    double ramp_s = v / chain.accel_mm_s2;
    double reaction_s = controller.reaction_us * 1e-6;
    double contact_s = ramp_s + (touch.approach_mm - ramp_mm) / v;
    double back_s = ramp_s + reaction_s; /* over the way of the reaction and one ramp */
    return contact_s + reaction_s + ramp_s + back_s;
}

void test_a_cycle_ends_no_sooner_than_its_release_has_bounced(void)
{
    chain.skip_latency_us = 0.0;
    controller.holdoff_us = 300000.0;
    play_one_well();
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, release_s() + 0.3, outcome.cycle_s);

    touch.path = SIM_PATH_PLC;
    play_one_well();
    /* Latch, way back, standstill, release and hold-off: each up to a scan later. */
    double latest_s = release_s() + 0.3 + 5.0 * chain.scan_us * 1e-6;
    TEST_ASSERT_TRUE(outcome.cycle_s >= release_s() + 0.3 && outcome.cycle_s <= latest_s);
}

/* ---- two touches ---- */

void test_the_second_touch_is_measured_at_its_own_feed(void)
{
    chain.skip_latency_us = 1000.0;
    controller.two_touches = 1;
    controller.back_off_mm = 0.25;
    controller.fast_feed_mm_min = FAST;
    touch.feed_mm_min = SLOW;
    play_one_well();

    TEST_ASSERT_DOUBLE_WITHIN(chain.resolution_um, 0.5, outcome.deviation_um);
    TEST_ASSERT_EQUAL_INT64(play_ns(outcome.true_edge_us) + 1000000, play_ns(outcome.latch_us));
}

/* The seed's point: a hundredth of the feed, a hundredth of the uncertainty. */
void test_two_touches_have_the_uncertainty_of_the_slow_one(void)
{
    double widest_um = 0.0;
    controller.two_touches = 1;
    controller.back_off_mm = 0.25;
    controller.fast_feed_mm_min = FAST;
    touch.feed_mm_min = SLOW;
    touch.path = SIM_PATH_PLC;
    for (unsigned i = 0u; i < 400u; ++i) {
        touch.time_s = 1.0 + 10.01e-3 * i;
        play_one_well();
        TEST_ASSERT_TRUE(outcome.deviation_um >= -chain.resolution_um);
        widest_um = fmax(widest_um, outcome.deviation_um);
    }
    TEST_ASSERT_TRUE(widest_um <= 2.0 + chain.resolution_um);
    TEST_ASSERT_TRUE(widest_um > 1.9);
}

void test_a_surface_out_of_reach_is_told(void)
{
    chain = PLAY_MACHINE;
    controller.overtravel_mm = chain.pretravel_um / UM_PER_MM - 0.001;
    play_one();
    TEST_ASSERT_EQUAL_INT32(TOUCH_ERR_NO_TOUCH, outcome.error);
    TEST_ASSERT_EQUAL_INT32(SIM_STATUS_MISSED, outcome.status);
    TEST_ASSERT_TRUE(isnan(outcome.latch_us));

    controller.overtravel_mm += 0.002;
    play_one_well();
}

/* The touch comes in the last µm, and is confirmed when the axis is at rest already. */
void test_a_touch_confirmed_at_standstill_does_not_turn_back_time(void)
{
    chain = PLAY_MACHINE;
    chain.delay_us = 0.0;
    controller.overtravel_mm = chain.pretravel_um / UM_PER_MM + 0.0005;
    controller.confirm_us = 50000.0;
    for (int32_t path = SIM_PATH_SKIP; path <= SIM_PATH_PLC; ++path) {
        touch.path = path;
        play_one_well();

        double confirmed_s = outcome.latch_us * 1e-6 + 0.05 - touch.time_s;
        double back_mm = touch.approach_mm + controller.overtravel_mm;
        TEST_ASSERT_TRUE(outcome.report_us >= outcome.latch_us + 50000.0);
        TEST_ASSERT_TRUE(outcome.cycle_s >=
                         confirmed_s + move_s(back_mm, touch.feed_mm_min) - 1e-6);
    }
}
