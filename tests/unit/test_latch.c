/* Arming, keeping the first edge, handing over the record, counting. */
/* LINK: firmware/input/latch.c tests/support/fake_critical.c tests/support/latch_checks.c */
#include <string.h>

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

/* ---- before arming ---- */

void test_a_new_latch_is_disarmed_and_empty(void)
{
    latch_check_nothing(&latch);
    TEST_ASSERT_FALSE(latch_level(&latch));
    TEST_ASSERT_FALSE(latch_is_confirming(&latch));
    TEST_ASSERT_EQUAL_UINT32(TICKS_NEVER, latch_idle_ticks(&latch, 0u));
    check_counters((latch_counters_t){0});
}

void test_initialising_again_forgets_everything(void)
{
    latch_arm(&latch, &NO_HOLDOFF);
    latch_on_edge(&latch, 10u, 1);
    latch_on_edge(&latch, 20u, 2);

    latch_init(&latch, CHANNEL, 0u);

    latch_check_nothing(&latch);
    TEST_ASSERT_FALSE(latch_level(&latch));
    check_counters((latch_counters_t){0});
}

void test_an_edge_while_disarmed_is_counted_and_not_kept(void)
{
    latch_on_edge(&latch, 10u, 1);
    latch_on_edge(&latch, 20u, 2);

    latch_check_nothing(&latch);
    check_counters((latch_counters_t){.unarmed = 2u});
}

void test_an_edge_from_before_arming_is_not_latched_afterwards(void)
{
    latch_on_edge(&latch, 10u, 1);

    latch_arm(&latch, &ONE_SHOT);

    latch_check_nothing(&latch);
}

/* ---- the record ---- */

void test_the_record_holds_time_and_position_of_the_edge(void)
{
    latch_arm(&latch, &ONE_SHOT);

    latch_on_edge(&latch, 0xFEDCBA98u, -123456789);

    latch_check_record(&latch, 0xFEDCBA98u, -123456789, 0u);
}

void test_the_record_names_its_channel(void)
{
    latch_arm(&latch, &ONE_SHOT);

    latch_on_edge(&latch, 1u, 1);

    TEST_ASSERT_EQUAL_UINT8(CHANNEL, latch_check_take(&latch).channel);
}

void test_every_record_carries_the_flags_given_at_the_start(void)
{
    latch_init(&latch, CHANNEL, LATCH_FLAG_PLC);
    latch_arm(&latch, &NO_HOLDOFF);

    for (uint32_t touch = 0u; touch < 3u; ++touch) {
        latch_on_edge(&latch, touch, 0);

        latch_check_record(&latch, touch, 0, LATCH_FLAG_PLC);
        latch_poll(&latch, touch, false);
    }
}

void test_a_record_is_taken_once(void)
{
    latch_arm(&latch, &ONE_SHOT);
    latch_on_edge(&latch, 10u, 1);

    latch_check_record(&latch, 10u, 1, 0u);
    latch_check_nothing(&latch);
}

void test_taking_nothing_leaves_the_callers_record_alone(void)
{
    latch_record_t record = {.ticks = 77u, .position_counts = -7, .sequence = 7u};

    TEST_ASSERT_FALSE(latch_take(&latch, &record));

    TEST_ASSERT_EQUAL_UINT32(77u, record.ticks);
    TEST_ASSERT_EQUAL_INT32(-7, record.position_counts);
    TEST_ASSERT_EQUAL_UINT16(7u, record.sequence);
}

void test_the_edge_is_seen_as_a_level_before_any_poll(void)
{
    latch_arm(&latch, &ONE_SHOT);

    latch_on_edge(&latch, 10u, 1);

    TEST_ASSERT_TRUE(latch_level(&latch));
}

void test_without_confirmation_nothing_waits_for_a_poll(void)
{
    latch_arm(&latch, &ONE_SHOT);

    latch_on_edge(&latch, 10u, 1);

    TEST_ASSERT_FALSE(latch_is_confirming(&latch));
    TEST_ASSERT_EQUAL_UINT32(TICKS_LOOK, latch_idle_ticks(&latch, 10u));
}

/* ---- arming and disarming ---- */

void test_arming_drops_a_record_that_nobody_took(void)
{
    latch_arm(&latch, &ONE_SHOT);
    latch_on_edge(&latch, 10u, 1);

    latch_arm(&latch, &ONE_SHOT);

    latch_check_nothing(&latch);
    check_counters((latch_counters_t){.overruns = 1u});
}

void test_after_arming_again_the_next_edge_is_the_first(void)
{
    arm_and_touch(&ONE_SHOT, 10u);

    latch_arm(&latch, &ONE_SHOT);
    latch_on_edge(&latch, 11u, 2); /* well inside the hold-off of the touch before */

    latch_check_record(&latch, 11u, 2, 0u);
    check_counters((latch_counters_t){0});
}

void test_arming_again_replaces_the_configuration(void)
{
    latch_arm(&latch, &REPEATED);
    latch_arm(&latch, &(latch_config_t){.confirm_ticks = 5u});

    latch_on_edge(&latch, 10u, 1);

    TEST_ASSERT_TRUE(latch_is_confirming(&latch));
}

/* ---- arming if the probe is free ---- */

static void check_armed_free(bool expected)
{
    TEST_ASSERT_EQUAL(expected, latch_arm_free(&latch, &ONE_SHOT));
    uint16_t unarmed = latch_counters(&latch).unarmed;
    latch_on_edge(&latch, 50u, 0);
    TEST_ASSERT_EQUAL_UINT16(unarmed + (expected ? 0u : 1u), latch_counters(&latch).unarmed);
}

void test_a_free_probe_is_armed(void)
{
    latch_poll(&latch, 10u, false);
    check_armed_free(true);
}

void test_a_deflected_probe_is_not_armed(void)
{
    latch_poll(&latch, 10u, true);
    check_armed_free(false);
}

void test_an_edge_since_the_last_poll_is_not_armed_over(void)
{
    latch_poll(&latch, 10u, false);
    latch_on_edge(&latch, 11u, 0);
    check_armed_free(false);
}

void test_disarming_does_not_make_an_edge_seen(void)
{
    latch_poll(&latch, 10u, false);
    latch_on_edge(&latch, 11u, 0);
    latch_disarm(&latch);
    check_armed_free(false);
}

void test_an_edge_that_was_over_at_the_last_poll_hinders_nothing(void)
{
    latch_on_edge(&latch, 11u, 0);
    latch_poll(&latch, 12u, false);
    check_armed_free(true);
}

void test_a_record_that_waits_stays_if_the_latch_is_not_armed(void)
{
    latch_arm(&latch, &ONE_SHOT);
    latch_on_edge(&latch, 10u, 3);
    TEST_ASSERT_FALSE(latch_arm_free(&latch, &ONE_SHOT));

    latch_check_record(&latch, 10u, 3, 0u);
}

/* ---- disarming ---- */

void test_disarming_keeps_a_record_to_be_taken(void)
{
    latch_arm(&latch, &ONE_SHOT);
    latch_on_edge(&latch, 10u, 1);

    latch_disarm(&latch);

    latch_check_record(&latch, 10u, 1, 0u);
}

void test_a_disarmed_latch_takes_no_more_edges(void)
{
    latch_arm(&latch, &REPEATED);
    latch_disarm(&latch);

    latch_on_edge(&latch, 10u, 1);

    latch_check_nothing(&latch);
    check_counters((latch_counters_t){.unarmed = 1u});
}

void test_the_configuration_is_copied(void)
{
    latch_config_t config = ONE_SHOT;
    latch_arm(&latch, &config);
    memset(&config, 0xFF, sizeof config);

    latch_on_edge(&latch, 10u, 1);

    latch_check_record(&latch, 10u, 1, 0u);
}

/* ---- counters ---- */

void test_counters_wrap_and_do_not_disturb_each_other(void)
{
    latch_arm(&latch, &ONE_SHOT);
    latch_on_edge(&latch, 0u, 0);
    for (uint32_t i = 0u; i < 0x10001u; ++i) {
        latch_on_edge(&latch, 1u, 0);
    }

    check_counters((latch_counters_t){.bounces = 1u});
}

void test_every_task_side_call_masks_interrupts_once(void)
{
    latch_record_t record;

    latch_arm(&latch, &ONE_SHOT);
    TEST_ASSERT_EQUAL_UINT(1u, fake_critical_sections());
    latch_disarm(&latch);
    TEST_ASSERT_EQUAL_UINT(2u, fake_critical_sections());
    latch_poll(&latch, 0u, false);
    TEST_ASSERT_EQUAL_UINT(3u, fake_critical_sections());
    (void)latch_take(&latch, &record);
    TEST_ASSERT_EQUAL_UINT(4u, fake_critical_sections());
    (void)latch_counters(&latch);
    TEST_ASSERT_EQUAL_UINT(5u, fake_critical_sections());
    (void)latch_arm_free(&latch, &ONE_SHOT);
    TEST_ASSERT_EQUAL_UINT(6u, fake_critical_sections());
}
