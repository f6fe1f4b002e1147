/* A probe by its mechanics, through the firmware's latch. */
/* LINK: tests/support/play.c $(OUT)/libskiplatch_sim.a */
#include <math.h>

#include "play.h"
#include "seat.h"
#include "unity.h"

#define TOUCHES       6000u /* more than one block of touches */
#define FEED_UM_US    0.01  /* of play_touch(): 600 mm/min */
#define LATE_US       17.0  /* delay, filter and latency of PLAY_MACHINE */
#define RESOLUTION_UM 0.001

static sim_chain_t   chain;
static sim_touch_t   touches[TOUCHES];
static sim_outcome_t outcomes[TOUCHES];

static const sim_rig_t rig = {.chain = &chain, .controller = &PLAY_ONE_TOUCH, .seed = 1u};

void setUp(void)
{
    chain = PLAY_MACHINE;
    chain.seat = (sim_seat_t){
        .spring_n = 5.0,
        .seat_mm = 5.0,
        .stylus_mm = 50.0,
        .stem_n_m2 = 2.0,
        .axial_um_n = 2.0,
        .evenness = 0.1,
    };
    for (uint64_t i = 0u; i < TOUCHES; ++i) {
        touches[i] = play_touch(i, SIM_PATH_SKIP, (double)i);
    }
}

void tearDown(void)
{
}

void test_the_mechanics_take_the_place_of_the_calibrated_pretravel(void)
{
    touches[0].alpha_deg = 60.0;
    touches[0].beta_deg = 30.0;
    play(&chain, &PLAY_ONE_TOUCH, touches, 2u, outcomes);

    play_check_ok(outcomes, 2u);
    for (size_t i = 0u; i < 2u; ++i) {
        double w_um = sim_seat_pretravel_um(&chain.seat, touches[i].alpha_deg, touches[i].beta_deg);
        TEST_ASSERT_DOUBLE_WITHIN(RESOLUTION_UM, w_um + FEED_UM_US * LATE_US,
                                  outcomes[i].deviation_um);
    }
}

/* To and fro: all but the first one find the tip on the other side. */
void test_a_change_of_direction_is_remembered_from_touch_to_touch(void)
{
    chain.seat.reseat_um = 2.0;
    chain.seat.evenness = 1.0;
    for (size_t i = 0u; i < TOUCHES; ++i) {
        touches[i].alpha_deg = i % 2u == 0u ? 0.0 : 180.0;
    }
    play(&chain, &PLAY_ONE_TOUCH, touches, TOUCHES, outcomes);

    TEST_ASSERT_DOUBLE_WITHIN(RESOLUTION_UM, 2.0,
                              outcomes[0].deviation_um - outcomes[1].deviation_um);
    for (size_t i = 2u; i < TOUCHES; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(RESOLUTION_UM, outcomes[1].deviation_um,
                                  outcomes[i].deviation_um);
    }
}

void test_a_second_touch_is_free_of_the_change_of_direction(void)
{
    sim_controller_t two_touches = PLAY_ONE_TOUCH;
    two_touches.two_touches = 1;
    two_touches.back_off_mm = 0.5;
    two_touches.fast_feed_mm_min = 1200.0;
    touches[1].alpha_deg = 180.0;
    chain.seat.evenness = 1.0;
    play(&chain, &two_touches, touches, 2u, outcomes);
    double exact_um = outcomes[1].deviation_um;
    chain.seat.reseat_um = 2.0;
    play(&chain, &two_touches, touches, 2u, outcomes);

    TEST_ASSERT_DOUBLE_WITHIN(RESOLUTION_UM, exact_um, outcomes[1].deviation_um);
}

void test_a_pull_is_refused(void)
{
    touches[0].beta_deg = -0.001;

    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, sim_play(&rig, touches, 1u, 1u, 1u, outcomes));
}

void test_a_seat_without_a_size_is_refused(void)
{
    double *sizes[] = {&chain.seat.seat_mm, &chain.seat.stylus_mm, &chain.seat.stem_n_m2};
    for (size_t i = 0u; i < sizeof sizes / sizeof *sizes; ++i) {
        double kept = *sizes[i];
        *sizes[i] = 0.0;
        TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_CHAIN, sim_play(&rig, touches, 1u, 1u, 1u, outcomes));
        *sizes[i] = kept;
    }
    chain.seat.spring_n = (double)NAN;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_CHAIN, sim_play(&rig, touches, 1u, 1u, 1u, outcomes));
}
