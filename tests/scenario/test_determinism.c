/* What comes of a touch depends on rig, seed, replicate and touch: not on threads, calls or order.
 */
/* LINK: tests/support/play.c tests/support/dice.c $(OUT)/libskiplatch_sim.a */
#include <string.h>

#include "api/rig.h"
#include "dice.h"
#include "play.h"
#include "unity.h"

#define TOUCHES    10000u /* more than two blocks of the library */
#define REPLICATES 3u

static const sim_controller_t TWO_TOUCHES = {
    .overtravel_mm = 5.0,
    .back_off_mm = 0.3,
    .fast_feed_mm_min = 3000.0,
    .reaction_us = 1000.0,
    .confirm_us = 300.0,
    .holdoff_us = 5000.0,
    .settle_us = 10000.0,
    .two_touches = 1,
};

static sim_chain_t   chain;
static sim_touch_t   touches[TOUCHES];
static sim_outcome_t expected[REPLICATES * TOUCHES];
static sim_outcome_t outcomes[REPLICATES * TOUCHES];

/* Touches of both paths in a row, some of them too short a pulse, everything noisy. */
static void fill(void)
{
    dice_t dice = dice_seed(1u);
    for (unsigned i = 0u; i < TOUCHES; ++i) {
        int32_t path = (int32_t)dice_below(&dice, 2u);
        touches[i] = play_touch(i, path, 1.0 * i + dice_between(&dice, 0.0, 0.3));
        touches[i].alpha_deg = dice_between(&dice, -180.0, 180.0);
        touches[i].pulse_us = dice_below(&dice, 4u) == 0u ? dice_between(&dice, 1.0, 8000.0) : 0.0;
    }
}

static void play_with(uint32_t threads, uint64_t first_replicate, uint64_t replicates,
                      const sim_touch_t *from, uint64_t n, sim_outcome_t *to)
{
    const sim_rig_t rig = {.chain = &chain,
                           .controller = &TWO_TOUCHES,
                           .seed = PLAY_SEED,
                           .replicate = first_replicate};
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, sim_play(&rig, from, n, replicates, threads, to));
}

void setUp(void)
{
    chain = PLAY_MACHINE;
    chain.repeatability_um = 1.0;
    chain.lobe_um = 5.0;
    chain.skip_jitter_us = 1.0;
    chain.report_jitter_us = 50.0;
    chain.tick_us = 0.25;
    fill();
    play_with(1u, 0u, REPLICATES, touches, TOUCHES, expected);
}

void tearDown(void)
{
}

static void check_identical(void)
{
    play_check_identical(expected, outcomes, REPLICATES * TOUCHES);
}

void test_any_number_of_threads_gives_the_same(void)
{
    static const uint32_t threads[] = {2u, 3u, 8u, 64u};
    for (size_t i = 0u; i < sizeof threads / sizeof *threads; ++i) {
        memset(outcomes, 0xA5, sizeof outcomes);
        play_with(threads[i], 0u, REPLICATES, touches, TOUCHES, outcomes);
        check_identical();
    }
}

void test_replicates_can_be_played_one_by_one(void)
{
    for (unsigned replicate = REPLICATES; replicate > 0u; --replicate) {
        play_with(1u, replicate - 1u, 1u, touches, TOUCHES, &outcomes[(replicate - 1u) * TOUCHES]);
    }
    check_identical();
}

void test_replicates_and_seeds_differ(void)
{
    sim_outcome_t other;
    TEST_ASSERT_NOT_EQUAL(0, memcmp(&expected[0], &expected[TOUCHES], sizeof *expected));
    const sim_rig_t rig = {.chain = &chain, .controller = &TWO_TOUCHES, .seed = PLAY_SEED + 1u};
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, sim_play(&rig, touches, 1u, 1u, 1u, &other));
    TEST_ASSERT_NOT_EQUAL(0, memcmp(&expected[0], &other, sizeof other));
}

void test_a_campaign_can_be_cut_anywhere(void)
{
    dice_t dice = dice_seed(2u);
    for (unsigned replicate = 0u; replicate < REPLICATES; ++replicate) {
        for (uint64_t begin = 0u, n = 0u; begin < TOUCHES; begin += n) {
            n = 1u + dice_below(&dice, 700u);
            n = begin + n < TOUCHES ? n : TOUCHES - begin;
            play_with(1u, replicate, 1u, &touches[begin], n,
                      &outcomes[replicate * TOUCHES + begin]);
        }
    }
    check_identical();
}

void test_every_touch_can_be_played_alone(void)
{
    for (unsigned i = 0u; i < TOUCHES; ++i) {
        play_with(1u, 0u, 1u, &touches[i], 1u, &outcomes[i]);
    }
    play_check_identical(expected, outcomes, TOUCHES);
}

static void swap(unsigned a, unsigned b, unsigned *order)
{
    sim_touch_t touch = touches[a];
    unsigned    place = order[a];
    touches[a] = touches[b];
    touches[b] = touch;
    order[a] = order[b];
    order[b] = place;
}

void test_touches_can_be_played_in_any_order(void)
{
    static unsigned order[TOUCHES];
    dice_t          dice = dice_seed(3u);
    for (unsigned i = 0u; i < TOUCHES; ++i) {
        order[i] = i;
    }
    for (unsigned i = TOUCHES - 1u; i > 0u; --i) {
        swap(i, dice_below(&dice, i + 1u), order);
    }
    play_with(2u, 0u, 1u, touches, TOUCHES, outcomes);

    for (unsigned i = 0u; i < TOUCHES; ++i) {
        play_check_identical(&expected[order[i]], &outcomes[i], 1u);
    }
}

static rig_t rigs[2];

void test_two_rigs_can_be_played_in_turns(void)
{
    sim_outcome_t outcome;
    for (unsigned replicate = 0u; replicate < 2u; ++replicate) {
        rig_boot(&rigs[replicate], &chain, &TWO_TOUCHES, NULL, 0u, PLAY_SEED, replicate, 0);
    }
    for (unsigned i = 0u; i < 200u; ++i) {
        unsigned replicate = i % 2u;
        TEST_ASSERT_EQUAL_INT(0, rig_play(&rigs[replicate], &touches[i], &outcome));
        play_check_identical(&expected[replicate * TOUCHES + i], &outcome, 1u);
    }
}

void test_no_touches_are_no_work(void)
{
    memset(outcomes, 0xA5, sizeof outcomes);
    sim_outcome_t untouched = outcomes[0];
    play_with(4u, 0u, 1u, touches, 0u, outcomes);
    play_with(4u, 0u, 0u, touches, TOUCHES, outcomes);

    TEST_ASSERT_EQUAL_INT(0, memcmp(&untouched, outcomes, sizeof untouched));
}
