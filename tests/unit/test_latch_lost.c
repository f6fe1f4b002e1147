/* What the latch drops is counted, and told of: nothing goes without a trace. */
/* LINK: firmware/input/latch.c tests/support/fake_critical.c tests/support/latch_checks.c */
#include "fake_critical.h"
#include "input/latch.h"
#include "latch_checks.h"
#include "unity.h"

#define CONFIRM 50u

static const latch_config_t AT_ONCE = {.confirm_ticks = 0u};
static const latch_config_t CONFIRMED = {.confirm_ticks = CONFIRM};

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

static void wait_for_confirmation(void)
{
    latch_arm(&latch, &CONFIRMED);
    latch_on_edge(&latch, 10u, 1);
}

/* ---- edges that wait ---- */

void test_disarming_counts_an_edge_that_waits(void)
{
    wait_for_confirmation();

    latch_disarm(&latch);

    latch_poll(&latch, 100u, true);
    latch_check_nothing(&latch);
    check_counters((latch_counters_t){.unarmed = 1u});
}

void test_arming_anew_counts_an_edge_that_waits(void)
{
    wait_for_confirmation();

    latch_arm(&latch, &CONFIRMED);

    check_counters((latch_counters_t){.unarmed = 1u});
}

void test_a_probe_whose_edge_waits_is_not_free(void)
{
    wait_for_confirmation();
    latch_poll(&latch, 20u, false);

    TEST_ASSERT_FALSE(latch_arm_free(&latch, &CONFIRMED));

    TEST_ASSERT_TRUE(latch_is_confirming(&latch));
    check_counters((latch_counters_t){0});
}

void test_an_edge_that_waits_hinders_disarming_if_asked_to(void)
{
    wait_for_confirmation();

    TEST_ASSERT_FALSE(latch_disarm_settled(&latch));

    latch_poll(&latch, 10u + CONFIRM, true);
    latch_check_record(&latch, 10u, 1, 0u);
}

void test_without_an_edge_that_waits_it_disarms(void)
{
    latch_arm(&latch, &CONFIRMED);

    TEST_ASSERT_TRUE(latch_disarm_settled(&latch));

    latch_on_edge(&latch, 10u, 1);
    check_counters((latch_counters_t){.unarmed = 1u});
}

/* ---- records ---- */

void test_a_record_dropped_by_arming_is_counted_and_flagged(void)
{
    latch_arm(&latch, &AT_ONCE);
    latch_on_edge(&latch, 10u, 1);

    latch_arm(&latch, &AT_ONCE);
    latch_on_edge(&latch, 20u, 2);

    check_counters((latch_counters_t){.overruns = 1u});
    latch_check_record(&latch, 20u, 2, LATCH_FLAG_OVERRUN);
}

void test_a_record_dropped_by_arming_a_free_probe_is_counted(void)
{
    latch_arm(&latch, &AT_ONCE);
    latch_on_edge(&latch, 10u, 1);
    latch_poll(&latch, 20u, false);

    TEST_ASSERT_TRUE(latch_arm_free(&latch, &AT_ONCE));

    check_counters((latch_counters_t){.overruns = 1u});
}

void test_a_record_lost_on_its_way_is_counted_and_flagged_once(void)
{
    latch_count_lost(&latch);

    for (uint32_t touch = 1u; touch <= 2u; ++touch) {
        latch_arm(&latch, &AT_ONCE);
        latch_on_edge(&latch, touch, 0);
        latch_check_record(&latch, touch, 0, touch == 1u ? LATCH_FLAG_OVERRUN : 0u);
    }
    check_counters((latch_counters_t){.overruns = 1u});
}

/* ---- edges while disarmed ---- */

void test_an_edge_while_disarmed_is_told_once(void)
{
    latch_on_edge(&latch, 10u, 1);

    TEST_ASSERT_TRUE(latch_take_unarmed(&latch));
    TEST_ASSERT_FALSE(latch_take_unarmed(&latch));
}

void test_a_new_latch_has_no_edge_to_tell_of(void)
{
    latch_on_edge(&latch, 10u, 1);
    latch_init(&latch, 0u, 0u);

    TEST_ASSERT_FALSE(latch_take_unarmed(&latch));
}
