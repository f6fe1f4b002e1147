/* Dividers, flip-flop, counter and needle of the phase meter. */
/* LINK: firmware/comp/phase_meter.c */
#include <math.h>

#include "comp/phase_meter.h"
#include "unity.h"

#define PERIOD 1000u
#define ONE    4294967296.0
#define TAU    250u

static phase_meter_t meter;

void setUp(void)
{
    phase_meter_init(&meter, 1u, 1u, TAU);
}

void tearDown(void)
{
}

/* The denser train's pulse, a period after the one before, and the gate's `lag` behind it. */
static bool play(int32_t lag)
{
    phase_meter_on_dense(&meter, 1u, PERIOD);
    return phase_meter_on_gate(&meter, 1u, lag);
}

void test_there_is_no_reading_before_a_whole_period(void)
{
    uint32_t lag_q32 = 0u;
    (void)phase_meter_on_gate(&meter, 0u, 0);
    (void)play(300);
    TEST_ASSERT_FALSE(phase_meter_digital(&meter, 300, &lag_q32));

    TEST_ASSERT_TRUE(play(300));

    TEST_ASSERT_TRUE(phase_meter_digital(&meter, 300, &lag_q32));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.3 * ONE, lag_q32);
}

void test_both_trains_are_divided_and_the_lag_begins_in_the_middle(void)
{
    uint32_t lag_q32 = 0u;
    uint32_t divided = 0u;
    phase_meter_init(&meter, 20u, 4u, TAU);
    (void)phase_meter_on_gate(&meter, 0u, 0);
    for (uint32_t i = 1u; i <= 200u; ++i) {
        phase_meter_on_dense(&meter, 1u, 10u);
        if (i % 5u == 0u && phase_meter_on_gate(&meter, 1u, 0)) {
            ++divided;
            (void)phase_meter_digital(&meter, 0, &lag_q32);
        }
    }

    TEST_ASSERT_EQUAL_UINT32(10u, divided);
    TEST_ASSERT_DOUBLE_WITHIN(0.06 * ONE, 0.5 * ONE, lag_q32);
}

void test_a_divided_pulse_that_is_missing_is_put_where_it_must_have_been(void)
{
    uint32_t lag_q32 = 0u;
    phase_meter_init(&meter, 10u, 1u, TAU);
    (void)phase_meter_on_gate(&meter, 0u, 0);
    for (uint32_t i = 1u; i <= 24u; ++i) {
        phase_meter_on_dense(&meter, 1u, 100u); /* the divided ones at 500 and 1500 */
    }
    phase_meter_on_dense(&meter, 4u, 400u); /* at 2800; 2500 was missing */

    TEST_ASSERT_TRUE(phase_meter_on_gate(&meter, 1u, 50));
    TEST_ASSERT_TRUE(phase_meter_digital(&meter, 50, &lag_q32));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.35 * ONE, lag_q32);
}

/* At a clock of 1 GHz a period may take longer than its counter goes round. */
void test_a_period_may_be_longer_than_the_clock_goes_round(void)
{
    uint32_t lag_q32 = 0u;
    phase_meter_init(&meter, 10u, 1u, UINT32_MAX);
    (void)phase_meter_on_gate(&meter, 0u, 0);
    for (uint32_t i = 1u; i <= 1000u; ++i) {
        phase_meter_on_dense(&meter, 1u, 2000000000u);
        if (i % 10u == 0u) {
            (void)phase_meter_on_gate(&meter, 1u, 500000000);
            (void)phase_meter_digital(&meter, 500000000, &lag_q32);
        }
    }

    TEST_ASSERT_DOUBLE_WITHIN(2.0, 0.525 * ONE, lag_q32); /* set at 5, 15, …; reset at 10.25 */
    TEST_ASSERT_TRUE(phase_meter_analog(&meter, &lag_q32));
    double rise = exp(-5.25 * 2.0e9 / UINT32_MAX);
    double fall = exp(-4.75 * 2.0e9 / UINT32_MAX);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8 * ONE, (1.0 - rise) / (1.0 - rise * fall) * ONE, lag_q32);
}

/* Charging towards 1 while set, towards 0 while not: the steady saw-tooth in closed form. */
void test_the_needle_swings_about_the_lag_like_a_low_pass(void)
{
    uint32_t lag_q32 = 0u;
    (void)phase_meter_on_gate(&meter, 0u, 0);
    for (uint32_t i = 0u; i < 40u; ++i) {
        (void)play(300);
    }
    double rise = exp(-300.0 / TAU);
    double fall = exp(-700.0 / TAU);

    TEST_ASSERT_TRUE(phase_meter_analog(&meter, &lag_q32));
    TEST_ASSERT_DOUBLE_WITHIN(20.0, (1.0 - rise) / (1.0 - rise * fall) * ONE, lag_q32);
}

void test_a_slow_needle_shows_the_mean(void)
{
    uint32_t lag_q32 = 0u;
    phase_meter_init(&meter, 1u, 1u, 1000u * PERIOD);
    (void)phase_meter_on_gate(&meter, 0u, 0);
    for (uint32_t i = 0u; i < 20000u; ++i) {
        (void)play(300);
    }

    TEST_ASSERT_TRUE(phase_meter_analog(&meter, &lag_q32));
    TEST_ASSERT_DOUBLE_WITHIN(0.001 * ONE, 0.3 * ONE, lag_q32);
}

void test_the_needle_is_read_once_it_is_warm(void)
{
    uint32_t lag_q32 = 0u;
    (void)phase_meter_on_gate(&meter, 0u, 0);
    (void)play(1);
    (void)play(999); /* 1999 ticks since it began: less than eight time constants */
    TEST_ASSERT_FALSE(phase_meter_analog(&meter, &lag_q32));

    (void)play(1);

    TEST_ASSERT_TRUE(phase_meter_analog(&meter, &lag_q32));
}

void test_a_needle_as_fast_as_a_tick_shows_the_flip_flop(void)
{
    uint32_t lag_q32 = 0u;
    phase_meter_init(&meter, 1u, 1u, 1u);
    (void)phase_meter_on_gate(&meter, 0u, 0);
    for (uint32_t i = 0u; i < 3u; ++i) {
        (void)play(500);
    }

    TEST_ASSERT_TRUE(phase_meter_analog(&meter, &lag_q32));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, lag_q32);
}
