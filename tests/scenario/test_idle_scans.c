/*
 * The simulation leaves out scans in which nothing can happen. A campaign that executes every
 * single one of them comes out the same to the last bit.
 */
/* LINK: tests/support/play.c tests/support/dice.c $(OUT)/libskiplatch_sim.a */
#include "dice.h"
#include "play.h"
#include "unity.h"

#define RIGS    400u
#define TOUCHES 25u

static sim_touch_t   touches[TOUCHES];
static sim_outcome_t lazy[TOUCHES];
static sim_outcome_t busy[TOUCHES];
static unsigned      errors_seen[8]; /* of touch_error_t */

void setUp(void)
{
}

void tearDown(void)
{
}

/* A quantity that is as often absent as not. */
static double maybe(dice_t *dice, double value)
{
    return dice_below(dice, 2u) == 0u ? 0.0 : value;
}

static sim_chain_t draw_chain(dice_t *dice)
{
    sim_chain_t chain = dice_below(dice, 2u) == 0u ? PLAY_BENCH : PLAY_MACHINE;
    chain.repeatability_um = maybe(dice, 5.0);
    chain.lobe_um = maybe(dice, 10.0);
    chain.filter_us = maybe(dice, dice_any_scale(dice, 1.0, 5000.0));
    chain.delay_us = maybe(dice, dice_any_scale(dice, 1.0, 20000.0));
    chain.skip_jitter_us = maybe(dice, 2.0);
    chain.tick_us = dice_below(dice, 2u) == 0u ? 0.25 : 1.0;
    chain.scan_us = dice_any_scale(dice, 200.0, 20000.0);
    chain.report_jitter_us = maybe(dice, 100.0);
    return chain;
}

static sim_controller_t draw_controller(dice_t *dice)
{
    return (sim_controller_t){
        /* Sometimes the surface, 0.1 mm of pretravel away, is out of reach. */
        .overtravel_mm = dice_any_scale(dice, 0.05, 10.0),
        .back_off_mm = dice_any_scale(dice, 0.01, 1.0),
        .fast_feed_mm_min = dice_any_scale(dice, 300.0, 6000.0),
        .reaction_us = maybe(dice, dice_any_scale(dice, 10.0, 20000.0)),
        .confirm_us = maybe(dice, dice_any_scale(dice, 1.0, 50000.0)),
        .holdoff_us = maybe(dice, dice_any_scale(dice, 1.0, 100000.0)),
        .settle_us = maybe(dice, dice_any_scale(dice, 1.0, 50000.0)),
        .two_touches = (int32_t)dice_below(dice, 2u),
        .image_delay_scans = (int32_t)(dice_below(dice, 2u) * dice_below(dice, 8u)),
    };
}

/* Far enough apart not to meet, most of them. */
static void draw_touches(dice_t *dice)
{
    double time_s = 0.0;
    for (unsigned i = 0u; i < TOUCHES; ++i) {
        time_s += dice_any_scale(dice, 0.1, 3.0);
        touches[i] =
            play_touch(i, dice_below(dice, 4u) == 0u ? SIM_PATH_SKIP : SIM_PATH_PLC, time_s);
        touches[i].feed_mm_min = dice_any_scale(dice, 100.0, 6000.0);
        touches[i].approach_mm = dice_any_scale(dice, 0.05, 3.0);
        touches[i].alpha_deg = dice_between(dice, -180.0, 180.0);
        touches[i].pulse_us = maybe(dice, maybe(dice, dice_any_scale(dice, 1.0, 50000.0)));
    }
}

/* One campaign in both ways. */
static void check_alike(const sim_chain_t *chain, sim_controller_t controller)
{
    controller.every_scan = 0;
    play(chain, &controller, touches, TOUCHES, lazy);
    controller.every_scan = 1;
    play(chain, &controller, touches, TOUCHES, busy);
    play_check_identical(busy, lazy, TOUCHES);
    for (unsigned i = 0u; i < TOUCHES; ++i) {
        ++errors_seen[busy[i].error & 7];
    }
}

static void check_rig(uint64_t seed)
{
    dice_t           dice = dice_seed(seed);
    sim_chain_t      chain = draw_chain(&dice);
    sim_controller_t controller = draw_controller(&dice);
    draw_touches(&dice);
    check_alike(&chain, controller);
}

void test_leaving_out_idle_scans_changes_nothing(void)
{
    for (uint64_t seed = 0u; seed < RIGS; ++seed) {
        check_rig(seed);
    }
    TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(RIGS * TOUCHES / 4u, errors_seen[0], "hardly any touch");
    TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(RIGS * TOUCHES / 50u, errors_seen[4], "hardly any miss");
}

/* Then what is due is due at a scan itself, and neither before nor after it. */
void test_times_of_whole_scans_are_over_at_a_scan(void)
{
    for (uint64_t seed = 0u; seed < RIGS; ++seed) {
        dice_t           dice = dice_seed(seed);
        sim_chain_t      chain = draw_chain(&dice);
        sim_controller_t controller = draw_controller(&dice);
        chain.scan_us = 1000.0 * (1.0 + dice_below(&dice, 8u));
        controller.confirm_us = chain.scan_us * dice_below(&dice, 4u);
        controller.holdoff_us = chain.scan_us * dice_below(&dice, 20u);
        controller.settle_us = chain.scan_us * dice_below(&dice, 10u);
        draw_touches(&dice);
        check_alike(&chain, controller);
    }
}
