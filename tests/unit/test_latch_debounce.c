/* Confirming and rejecting an edge by the level that follows; what a poll tells of the level. */
/* LINK: firmware/input/latch.c tests/support/fake_critical.c tests/support/latch_checks.c */
#include "epochs.h"
#include "fake_critical.h"
#include "input/latch.h"
#include "input/ticks.h"
#include "latch_checks.h"
#include "unity.h"

#define CONFIRM 50u
#define HOLDOFF 200u

static const latch_config_t ONE_SHOT = {
    .repeated = false, .confirm_ticks = CONFIRM, .holdoff_ticks = HOLDOFF};
static const latch_config_t REPEATED = {
    .repeated = true, .confirm_ticks = CONFIRM, .holdoff_ticks = HOLDOFF};

static latch_t latch;

void setUp(void)
{
    fake_critical_reset(NULL);
    latch_init(&latch, 0u, 0u);
}

void tearDown(void)
{
    fake_critical_verify();
}

static void check_counters(latch_counters_t expected)
{
    latch_check_counters(&latch, &expected);
}

/* A fresh latch that has just kept an edge at position 7. */
static void arm_and_touch(const latch_config_t *config, uint32_t ticks)
{
    latch_init(&latch, 0u, 0u);
    latch_arm(&latch, config);
    latch_on_edge(&latch, ticks, 7);
}

/* ---- confirming ---- */

void test_an_edge_waits_to_be_confirmed(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);

    TEST_ASSERT_TRUE(latch_is_confirming(&latch));
    latch_check_nothing(&latch);
}

void test_a_level_that_rests_confirms_to_the_tick(void)
{
    FOR_EACH_EPOCH (edge) {
        arm_and_touch(&ONE_SHOT, edge);

        latch_poll(&latch, edge + CONFIRM - 1u, true);
        latch_check_nothing(&latch);
        TEST_ASSERT_TRUE(latch_is_confirming(&latch));

        latch_poll(&latch, edge + CONFIRM, true);
        TEST_ASSERT_FALSE(latch_is_confirming(&latch));
        latch_check_record(&latch, edge, 7, 0u);
    }
}

void test_a_late_poll_confirms_with_the_time_of_the_edge(void)
{
    FOR_EACH_EPOCH (edge) {
        arm_and_touch(&ONE_SHOT, edge);

        latch_poll(&latch, edge + 0x70000000u, true);

        latch_check_record(&latch, edge, 7, 0u);
    }
}

void test_the_wait_is_told_to_the_tick(void)
{
    FOR_EACH_EPOCH (edge) {
        arm_and_touch(&ONE_SHOT, edge);

        TEST_ASSERT_EQUAL_UINT32(CONFIRM, latch_idle_ticks(&latch, edge));
        TEST_ASSERT_EQUAL_UINT32(1u, latch_idle_ticks(&latch, edge + CONFIRM - 1u));
        TEST_ASSERT_EQUAL_UINT32(0u, latch_idle_ticks(&latch, edge + CONFIRM));
        latch_poll(&latch, edge + CONFIRM, true);
        TEST_ASSERT_EQUAL_UINT32(TICKS_LOOK, latch_idle_ticks(&latch, edge + CONFIRM));
    }
}

void test_a_confirmed_one_shot_takes_no_second_touch(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    latch_poll(&latch, 1000u + CONFIRM, true);
    (void)latch_check_take(&latch);

    latch_on_edge(&latch, 1000u + HOLDOFF, 8);
    latch_poll(&latch, 1000u + HOLDOFF + CONFIRM, true);

    latch_check_nothing(&latch);
    check_counters((latch_counters_t){.unarmed = 1u});
}

void test_repeated_confirms_touch_after_touch(void)
{
    latch_arm(&latch, &REPEATED);
    for (uint32_t edge = 0xFFFFFE00u; edge != 0x200u; edge += 0x100u) {
        latch_on_edge(&latch, edge, (int32_t)edge);
        latch_poll(&latch, edge + CONFIRM, true);

        latch_check_record(&latch, edge, (int32_t)edge, 0u);
        latch_poll(&latch, edge + 0xF0u, false);
    }
    check_counters((latch_counters_t){0});
}

/* The hold-off counts from the first edge, however long confirming takes. */
void test_a_hold_off_shorter_than_the_confirmation_is_over_with_it(void)
{
    const latch_config_t short_holdoff = {
        .repeated = true, .confirm_ticks = CONFIRM, .holdoff_ticks = CONFIRM - 1u};
    arm_and_touch(&short_holdoff, 1000u);
    latch_poll(&latch, 1000u + CONFIRM, true);
    (void)latch_check_take(&latch);

    latch_on_edge(&latch, 1000u + CONFIRM, 8);

    TEST_ASSERT_TRUE(latch_is_confirming(&latch));
    check_counters((latch_counters_t){0});
}

void test_a_confirmed_touch_that_finds_the_last_one_untaken_is_an_overrun(void)
{
    arm_and_touch(&REPEATED, 1000u);
    latch_poll(&latch, 1000u + CONFIRM, true);
    latch_on_edge(&latch, 2000u, 8);

    check_counters((latch_counters_t){0});
    latch_poll(&latch, 2000u + CONFIRM, true);
    check_counters((latch_counters_t){.overruns = 1u});
    latch_check_record(&latch, 1000u, 7, 0u);
}

/* ---- rejecting ---- */

void test_a_level_that_falls_back_and_rests_rejects_to_the_tick(void)
{
    FOR_EACH_EPOCH (edge) {
        arm_and_touch(&ONE_SHOT, edge);

        latch_poll(&latch, edge + 10u, false);
        latch_poll(&latch, edge + 10u + CONFIRM - 1u, false);
        check_counters((latch_counters_t){0});
        latch_poll(&latch, edge + 10u + CONFIRM, false);

        check_counters((latch_counters_t){.glitches = 1u});
        TEST_ASSERT_FALSE(latch_is_confirming(&latch));
        latch_check_nothing(&latch);
    }
}

void test_after_a_glitch_the_next_edge_is_the_first_even_of_a_one_shot(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    latch_poll(&latch, 1010u, false);
    latch_poll(&latch, 1010u + CONFIRM, false);

    latch_on_edge(&latch, 1070u, 8); /* no hold-off after a glitch */
    latch_poll(&latch, 1070u + CONFIRM, true);

    latch_check_record(&latch, 1070u, 8, 0u);
    check_counters((latch_counters_t){.glitches = 1u});
}

void test_a_glitch_leaves_no_flag_on_the_touch_after_it(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    latch_on_edge(&latch, 1005u, 0);
    latch_poll(&latch, 1010u, false);
    latch_poll(&latch, 1010u + CONFIRM, false);

    latch_on_edge(&latch, 1100u, 8);
    latch_poll(&latch, 1100u + CONFIRM, true);

    latch_check_record(&latch, 1100u, 8, 0u);
}

/* ---- how often to poll ---- */

void test_a_glitch_and_a_touch_between_two_polls_are_one_touch_that_bounced(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    latch_on_edge(&latch, 1000u + 50u * CONFIRM, 8);

    latch_poll(&latch, 1000u + 100u * CONFIRM, true);

    latch_check_record(&latch, 1000u, 7, LATCH_FLAG_BOUNCED);
}

void test_polls_more_often_than_the_confirmation_tell_a_glitch_from_the_touch_behind_it(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    for (uint32_t passed = CONFIRM - 1u; passed < 50u * CONFIRM; passed += CONFIRM - 1u) {
        latch_poll(&latch, 1000u + passed, false);
    }
    latch_on_edge(&latch, 1000u + 50u * CONFIRM, 8);

    latch_poll(&latch, 1000u + 51u * CONFIRM, true);

    latch_check_record(&latch, 1000u + 50u * CONFIRM, 8, 0u);
}

/* ---- disarming and arming while an edge waits ---- */

void test_disarming_gives_up_an_edge_that_waits(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);

    latch_disarm(&latch);
    latch_poll(&latch, 1000u + CONFIRM, true);

    latch_check_nothing(&latch);
    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER, latch_idle_ticks(&latch, 1000u));
}

void test_arming_gives_up_an_edge_that_waits(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);

    latch_arm(&latch, &ONE_SHOT);
    latch_poll(&latch, 1000u + CONFIRM, true);

    TEST_ASSERT_FALSE(latch_is_confirming(&latch));
    latch_check_nothing(&latch);
}

/* ---- the level ---- */

void test_the_level_is_that_of_the_last_poll(void)
{
    latch_poll(&latch, 10u, true);
    TEST_ASSERT_TRUE(latch_level(&latch));

    latch_poll(&latch, 20u, false);
    TEST_ASSERT_FALSE(latch_level(&latch));
}

void test_an_unarmed_edge_leaves_the_level_to_the_polls(void)
{
    latch_on_edge(&latch, 10u, 1);
    TEST_ASSERT_FALSE(latch_level(&latch));

    latch_poll(&latch, 20u, true);
    TEST_ASSERT_TRUE(latch_level(&latch));
}

void test_a_level_is_no_edge(void)
{
    latch_arm(&latch, &ONE_SHOT);

    latch_poll(&latch, 10u, true);
    latch_poll(&latch, 10u + CONFIRM, true);

    latch_check_nothing(&latch);
    check_counters((latch_counters_t){0});
}

/* ---- the edge comes between the task's reading of the clock or of the level and its poll ---- */

void test_a_poll_whose_clock_was_read_before_the_edge_confirms_nothing(void)
{
    FOR_EACH_EPOCH (edge) {
        arm_and_touch(&ONE_SHOT, edge);

        latch_poll(&latch, edge - 1u, true);
        latch_check_nothing(&latch);
        TEST_ASSERT_EQUAL_UINT32(CONFIRM, latch_idle_ticks(&latch, edge - 1u));

        latch_poll(&latch, edge + CONFIRM, true);
        latch_check_record(&latch, edge, 7, 0u);
    }
}

void test_a_poll_whose_level_was_read_before_the_edge_rejects_nothing(void)
{
    FOR_EACH_EPOCH (edge) {
        arm_and_touch(&ONE_SHOT, edge);

        latch_poll(&latch, edge - 1u, false);
        latch_poll(&latch, edge + CONFIRM, true);
        check_counters((latch_counters_t){0});

        latch_poll(&latch, edge + 2u * CONFIRM, true);
        latch_check_record(&latch, edge, 7, 0u);
    }
}
