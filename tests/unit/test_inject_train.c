/* The train: pulses come when they are due, keep their width, and lateness does not add up. */
/* LINK: firmware/inject/inject_train.c */
#include "inject/inject_train.h"
#include "unity.h"

#define START_US 0xFFFFFF00u /* the clock wraps within every train */

static inject_train_t train;

static const inject_shot_t SHOT = {
    .level = 1u, .count = 3u, .delay_us = 200u, .width_us = 50u, .period_us = 300u};

void setUp(void)
{
    inject_train_begin(&train, &SHOT, START_US);
}

void tearDown(void)
{
}

/* Drive the line `late_us` after it is due; returns when that is, since the trigger. */
static uint32_t drive(uint32_t late_us)
{
    uint32_t due_us = START_US + inject_train_wait_us(&train, START_US);
    inject_train_advance(&train, due_us + late_us);
    return due_us - START_US;
}

void test_nothing_plays_at_first(void)
{
    train = (inject_train_t){.remaining = 0u};

    TEST_ASSERT_FALSE(inject_train_is_playing(&train));
}

void test_pulses_come_after_the_delay_at_their_period_with_their_width(void)
{
    const uint32_t expected_us[] = {200u, 250u, 500u, 550u, 800u, 850u};
    for (unsigned i = 0u; i < 6u; ++i) {
        TEST_ASSERT_TRUE(inject_train_is_playing(&train));
        TEST_ASSERT_EQUAL(i % 2u == 0u, inject_train_is_leading(&train));
        TEST_ASSERT_EQUAL_UINT8(i % 2u == 0u, inject_train_level(&train));
        TEST_ASSERT_EQUAL_UINT32(expected_us[i], drive(0u));
    }

    TEST_ASSERT_FALSE(inject_train_is_playing(&train));
}

void test_low_pulses_end_high(void)
{
    train.shot.level = 0u;

    TEST_ASSERT_EQUAL_UINT8(0u, inject_train_level(&train));
    (void)drive(0u);
    TEST_ASSERT_EQUAL_UINT8(1u, inject_train_level(&train));
}

void test_a_late_pulse_keeps_its_width_and_the_next_its_time(void)
{
    TEST_ASSERT_EQUAL_UINT32(200u, drive(120u));
    TEST_ASSERT_EQUAL_UINT32(370u, drive(0u));
    TEST_ASSERT_EQUAL_UINT32(500u, drive(0u));
}

void test_what_is_due_or_late_does_not_wait(void)
{
    TEST_ASSERT_EQUAL_UINT32(1u, inject_train_wait_us(&train, START_US + 199u));
    TEST_ASSERT_EQUAL_UINT32(0u, inject_train_wait_us(&train, START_US + 200u));
    TEST_ASSERT_EQUAL_UINT32(0u, inject_train_wait_us(&train, START_US + 20000u));
}
