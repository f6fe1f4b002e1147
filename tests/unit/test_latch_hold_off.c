/* The hold-off after a touch, touch after touch, and touches that find the last one untaken. */
/* LINK: firmware/input/latch.c tests/support/fake_critical.c tests/support/latch_checks.c */
#include "epochs.h"
#include "fake_critical.h"
#include "input/latch.h"
#include "input/ticks.h"
#include "latch_checks.h"
#include "unity.h"

#define CHANNEL 5u
#define HOLDOFF 100u

static const latch_config_t ONE_SHOT = {.repeated = false, .holdoff_ticks = HOLDOFF};
static const latch_config_t REPEATED = {.repeated = true, .holdoff_ticks = HOLDOFF};
static const latch_config_t NO_HOLDOFF = {.repeated = true};

static latch_t latch;

void setUp(void)
{
    fake_critical_reset(NULL);
    latch_init(&latch, CHANNEL, 0u);
}

void tearDown(void)
{
    fake_critical_verify();
}

static void check_counters(latch_counters_t expected)
{
    latch_check_counters(&latch, &expected);
}

/* A touch, bounce and all, that an application armed for `config` has taken. */
static void arm_and_touch(const latch_config_t *config, uint32_t ticks)
{
    latch_arm(&latch, config);
    latch_on_edge(&latch, ticks, 0);
    (void)latch_check_take(&latch);
}

/* ---- hold-off ---- */

void test_edges_within_the_hold_off_are_bounces(void)
{
    FOR_EACH_EPOCH (touch) {
        latch_init(&latch, CHANNEL, 0u);
        arm_and_touch(&REPEATED, touch);

        latch_on_edge(&latch, touch + 1u, 1);
        latch_on_edge(&latch, touch + HOLDOFF - 1u, 2);

        latch_check_nothing(&latch);
        check_counters((latch_counters_t){.bounces = 2u});
    }
}

void test_an_edge_at_the_end_of_the_hold_off_is_a_touch(void)
{
    FOR_EACH_EPOCH (touch) {
        latch_init(&latch, CHANNEL, 0u);
        arm_and_touch(&REPEATED, touch);

        latch_on_edge(&latch, touch + HOLDOFF, 3);

        latch_check_record(&latch, touch + HOLDOFF, 3, 0u);
        check_counters((latch_counters_t){0});
    }
}

void test_bounces_do_not_prolong_the_hold_off(void)
{
    arm_and_touch(&REPEATED, 1000u);
    latch_on_edge(&latch, 1000u + HOLDOFF - 1u, 1);

    latch_on_edge(&latch, 1000u + HOLDOFF, 2);

    latch_check_record(&latch, 1000u + HOLDOFF, 2, 0u);
}

void test_a_bounce_leaves_the_waiting_record_as_it_was(void)
{
    latch_arm(&latch, &REPEATED);
    latch_on_edge(&latch, 1000u, 1);

    latch_on_edge(&latch, 1010u, 2);

    latch_check_record(&latch, 1000u, 1, 0u);
}

void test_without_hold_off_every_edge_is_a_touch(void)
{
    arm_and_touch(&NO_HOLDOFF, 1000u);

    latch_on_edge(&latch, 1000u, 1);

    latch_check_record(&latch, 1000u, 1, 0u);
}

void test_polls_end_the_hold_off_at_its_end_and_not_before(void)
{
    FOR_EACH_EPOCH (touch) {
        latch_init(&latch, CHANNEL, 0u);
        arm_and_touch(&ONE_SHOT, touch);

        latch_poll(&latch, touch + HOLDOFF - 1u, true);
        latch_on_edge(&latch, touch + HOLDOFF - 1u, 1);
        check_counters((latch_counters_t){.bounces = 1u});

        latch_poll(&latch, touch + HOLDOFF, true);
        latch_on_edge(&latch, touch + HOLDOFF, 1);
        check_counters((latch_counters_t){.bounces = 1u, .unarmed = 1u});
    }
}

/* The clock comes round to the touch again; the poll in between has ended the hold-off for good. */
void test_a_hold_off_ended_by_a_poll_does_not_come_back_with_the_clock(void)
{
    arm_and_touch(&REPEATED, 1000u);
    latch_poll(&latch, 1000u + HOLDOFF, false);

    latch_on_edge(&latch, 1000u + 0xF0000000u, 4);

    latch_check_record(&latch, 1000u + 0xF0000000u, 4, 0u);
}

/* A task that sleeps as long as it may: no touch, however late, is taken for a bounce. */
static void check_touch_after(uint32_t edge, uint32_t rest)
{
    uint32_t slept = 0u;
    latch_arm(&latch, &REPEATED);
    latch_on_edge(&latch, edge, 1);
    (void)latch_check_take(&latch);
    for (;;) {
        latch_poll(&latch, edge + slept, false);
        uint32_t idle = latch_idle_ticks(&latch, edge + slept);
        if (idle > rest - slept) {
            break;
        }
        slept += idle;
    }

    latch_on_edge(&latch, edge + rest, 2);
    latch_check_record(&latch, edge + rest, 2, 0u);
}

void test_a_touch_is_none_of_the_last_one_however_late_it_comes(void)
{
    FOR_EACH_EPOCH (edge) {
        for (uint32_t rest = HOLDOFF; rest < UINT32_MAX - TICKS_LOOK / 8u;
             rest += TICKS_LOOK / 8u) {
            check_touch_after(edge, rest);
        }
    }
}

void test_a_hold_off_asks_for_polls_until_it_is_over(void)
{
    latch_arm(&latch, &REPEATED);
    latch_on_edge(&latch, 10u, 1);
    TEST_ASSERT_EQUAL_UINT32(TICKS_LOOK, latch_idle_ticks(&latch, 10u));

    latch_poll(&latch, 10u + HOLDOFF, false);
    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER, latch_idle_ticks(&latch, 10u + HOLDOFF));
}

void test_a_poll_read_before_the_edge_does_not_end_the_hold_off(void)
{
    arm_and_touch(&REPEATED, 1000u);

    latch_poll(&latch, 999u, true);
    latch_on_edge(&latch, 1001u, 2);

    latch_check_nothing(&latch);
    check_counters((latch_counters_t){.bounces = 1u});
}

/* ---- one-shot and repeated ---- */

void test_one_shot_takes_one_touch(void)
{
    arm_and_touch(&ONE_SHOT, 1000u);

    latch_on_edge(&latch, 1000u + HOLDOFF, 1);

    latch_check_nothing(&latch);
    check_counters((latch_counters_t){.unarmed = 1u});
}

void test_repeated_takes_touch_after_touch(void)
{
    latch_arm(&latch, &REPEATED);

    for (uint32_t touch = 0u; touch < 5u; ++touch) {
        uint32_t ticks = 0xFFFFFF00u + touch * HOLDOFF;
        latch_on_edge(&latch, ticks, (int32_t)touch);

        latch_check_record(&latch, ticks, (int32_t)touch, 0u);
    }
    check_counters((latch_counters_t){0});
}

/* ---- overruns ---- */

void test_a_touch_that_finds_the_last_one_untaken_is_lost_and_counted(void)
{
    latch_arm(&latch, &NO_HOLDOFF);
    latch_on_edge(&latch, 10u, 1);

    latch_on_edge(&latch, 20u, 2);
    latch_on_edge(&latch, 30u, 3);

    check_counters((latch_counters_t){.overruns = 2u});
    latch_check_record(&latch, 10u, 1, 0u);
    latch_check_nothing(&latch);
}

void test_the_record_after_a_loss_says_so_and_the_one_after_that_does_not(void)
{
    latch_arm(&latch, &NO_HOLDOFF);
    latch_on_edge(&latch, 10u, 1);
    latch_on_edge(&latch, 20u, 2);
    (void)latch_check_take(&latch);

    latch_on_edge(&latch, 30u, 3);
    latch_check_record(&latch, 30u, 3, LATCH_FLAG_OVERRUN);
    latch_on_edge(&latch, 40u, 4);
    latch_check_record(&latch, 40u, 4, 0u);
}

void test_a_loss_is_still_told_after_arming_again(void)
{
    latch_arm(&latch, &NO_HOLDOFF);
    latch_on_edge(&latch, 10u, 1);
    latch_on_edge(&latch, 20u, 2);

    latch_arm(&latch, &NO_HOLDOFF);
    latch_on_edge(&latch, 30u, 3);

    latch_check_record(&latch, 30u, 3, LATCH_FLAG_OVERRUN);
}
