/* Bounces while an edge waits to be confirmed: the first edge counts, once the level rests. */
/* LINK: firmware/input/latch.c tests/support/fake_critical.c tests/support/latch_checks.c */
#include "epochs.h"
#include "fake_critical.h"
#include "input/latch.h"
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

/* ---- bounces ---- */

void test_a_bounce_never_moves_the_first_edge(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    latch_poll(&latch, 1010u, false);
    latch_on_edge(&latch, 1020u, 99);
    latch_poll(&latch, 1020u + CONFIRM, true);

    latch_check_record(&latch, 1000u, 7, LATCH_FLAG_BOUNCED);
    check_counters((latch_counters_t){.bounces = 1u});
}

void test_each_bounce_begins_the_rest_anew(void)
{
    FOR_EACH_EPOCH (edge) {
        arm_and_touch(&ONE_SHOT, edge);
        latch_on_edge(&latch, edge + CONFIRM - 1u, 99);

        latch_poll(&latch, edge + 2u * CONFIRM - 2u, true);
        latch_check_nothing(&latch);
        latch_poll(&latch, edge + 2u * CONFIRM - 1u, true);
        latch_check_record(&latch, edge, 7, LATCH_FLAG_BOUNCED);
    }
}

void test_bounces_seen_only_by_polls_begin_the_rest_anew_too(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    latch_poll(&latch, 1020u, false);
    latch_poll(&latch, 1040u, true);

    latch_poll(&latch, 1040u + CONFIRM - 1u, true);
    latch_check_nothing(&latch);
    latch_poll(&latch, 1040u + CONFIRM, true);
    latch_check_record(&latch, 1000u, 7, 0u);
}

void test_a_long_train_of_bounces_confirms_the_first_edge(void)
{
    arm_and_touch(&ONE_SHOT, 0xFFFFFF00u);
    for (uint32_t i = 1u; i <= 100u; ++i) {
        latch_on_edge(&latch, 0xFFFFFF00u + 10u * i, (int32_t)i);
        latch_poll(&latch, 0xFFFFFF00u + 10u * i + 5u, i % 2u == 0u);
    }
    latch_poll(&latch, 0xFFFFFF00u + 1005u + CONFIRM, true);

    latch_check_record(&latch, 0xFFFFFF00u, 7, LATCH_FLAG_BOUNCED);
    check_counters((latch_counters_t){.bounces = 100u});
}

void test_a_bounce_after_the_confirmation_does_not_mark_the_record(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);
    latch_poll(&latch, 1000u + CONFIRM, true);

    latch_on_edge(&latch, 1000u + CONFIRM + 1u, 99);

    latch_check_record(&latch, 1000u, 7, 0u);
}

void test_the_mark_of_a_bounce_does_not_stay_for_the_next_touch(void)
{
    arm_and_touch(&REPEATED, 1000u);
    latch_on_edge(&latch, 1010u, 99);
    latch_poll(&latch, 1010u + CONFIRM, true);
    latch_check_record(&latch, 1000u, 7, LATCH_FLAG_BOUNCED);

    latch_on_edge(&latch, 2000u, 8);
    latch_poll(&latch, 2000u + CONFIRM, true);

    latch_check_record(&latch, 2000u, 8, 0u);
}
