/* hal_pulse.h: what is kept of two pulse trains, in which order, with what time. */
/* LINK: host_sim/tests/pulse_lines.c $(OUT)/libskiplatch_sim.a */
#include "../contract/pulse_lines_under_test.h"
#include "hal_clock.h"
#include "hal_error.h"
#include "hal_pulse.h"
#include "input/ticks.h"
#include "unity.h"

#define NEAR_THE_WRAP (UINT32_MAX - 20000u)

static hal_pulse_t pulse;

void setUp(void)
{
    pulse_lines_power_up(0u);
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_pulse_start(HAL_PULSE_RISING));
}

void tearDown(void)
{
    hal_pulse_stop();
}

/* A pulse, and time enough for it to arrive. */
static void give(uint8_t channel)
{
    pulse_line_set(channel, true);
    pulse_lines_pass_us(PULSES.latency_us + 1u);
    pulse_line_set(channel, false);
    pulse_lines_pass_us(PULSES.latency_us + 1u);
}

/* So many pulses as fast as the port can note them. */
static void give_train(uint32_t count)
{
    for (uint32_t i = 0u; i < count; ++i) {
        pulse_line_set(i % HAL_PULSE_CHANNELS, true);
        pulse_lines_pass_us(PULSES.spacing_us);
        pulse_line_set(i % HAL_PULSE_CHANNELS, false);
    }
    pulse_lines_pass_us(PULSES.latency_us + 1u);
}

static unsigned taken_in_all(void)
{
    unsigned count = 0u;
    while (hal_pulse_take(&pulse)) {
        ++count;
    }
    return count;
}

static void check_nothing_comes(void)
{
    pulse_lines_pass_us(10u * PULSES.latency_us);
    TEST_ASSERT_EQUAL_UINT(0u, taken_in_all());
}

/* ---- what is handed out ---- */

void test_without_a_pulse_nothing_is_handed_out(void)
{
    check_nothing_comes();
}

void test_a_pulse_is_handed_out_once_and_names_its_channel(void)
{
    for (uint8_t channel = 0u; channel < HAL_PULSE_CHANNELS; ++channel) {
        give(channel);

        TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
        TEST_ASSERT_EQUAL_UINT8(channel, pulse.channel);
        TEST_ASSERT_EQUAL_UINT8(0u, pulse.lost);
        check_nothing_comes();
    }
}

void test_pulses_are_kept_in_their_order(void)
{
    const uint8_t order[] = {0u, 1u, 1u, 0u, 0u, 0u, 1u, 0u};
    uint32_t      last = hal_clock_now_ticks();
    for (unsigned i = 0u; i < sizeof order; ++i) {
        give(order[i]);
    }
    for (unsigned i = 0u; i < sizeof order; ++i) {
        TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
        TEST_ASSERT_EQUAL_UINT8(order[i], pulse.channel);
        TEST_ASSERT_LESS_THAN_UINT32(0x80000000u, ticks_elapsed(pulse.captured_ticks, last));
        last = pulse.captured_ticks;
    }
}

void test_both_lines_at_once_are_both_handed_out(void)
{
    unsigned channels = 0u;
    pulse_line_set(0u, true);
    pulse_line_set(1u, true);
    pulse_lines_pass_us(2u * PULSES.latency_us);
    while (hal_pulse_take(&pulse)) {
        channels |= 1u << pulse.channel;
    }

    TEST_ASSERT_EQUAL_UINT(3u, channels);
}

/* ---- time ---- */

static void check_stamps_to(uint32_t latency_ticks, unsigned pulses)
{
    for (unsigned i = 0u; i < pulses; ++i) {
        uint8_t  channel = i % HAL_PULSE_CHANNELS;
        uint32_t before = hal_clock_now_ticks();
        give(channel);

        TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency_ticks,
                                         ticks_elapsed(pulse.captured_ticks, before));
    }
}

static uint32_t latency_ticks(void)
{
    return ticks_from_us(PULSES.latency_us, hal_clock_tick_ps()) + 1u;
}

void test_the_captured_time_is_that_of_the_edge(void)
{
    check_stamps_to(latency_ticks(), 40u);
}

void test_the_captured_time_stays_that_of_the_edge_when_nobody_takes_it(void)
{
    uint32_t latency = latency_ticks();
    for (uint8_t channel = 0u; channel < HAL_PULSE_CHANNELS; ++channel) {
        uint32_t before = hal_clock_now_ticks();
        give(channel);
        pulse_lines_pass_us(50000u);

        TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency, ticks_elapsed(pulse.captured_ticks, before));
    }
}

void test_pulses_are_stamped_right_across_the_wrap_of_the_clock(void)
{
    uint32_t latency = latency_ticks();
    pulse_lines_power_up(NEAR_THE_WRAP);
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_pulse_start(HAL_PULSE_RISING));
    while (hal_clock_now_ticks() > 0x80000000u) {
        check_stamps_to(latency, HAL_PULSE_CHANNELS);
    }
    check_stamps_to(latency, HAL_PULSE_CHANNELS);
}

/* ---- more than there is room for ---- */

/* What was dropped is told by the first pulse for which there is room again. */
void test_pulses_without_room_are_told_by_the_next_one(void)
{
    uint32_t given = PULSES.held_most + 3u;
    give_train(given);
    unsigned handed_out = 0u;
    unsigned lost = 0u;
    while (hal_pulse_take(&pulse)) {
        ++handed_out;
        lost += pulse.lost;
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT(PULSES.held_most, handed_out);
    give(0u);

    TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
    TEST_ASSERT_EQUAL_UINT(given, handed_out + lost + pulse.lost);
    give(1u);
    TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
    TEST_ASSERT_EQUAL_UINT8(0u, pulse.lost);
}

void test_many_lost_pulses_stay_many(void)
{
    give_train(PULSES.held_most + 300u);
    unsigned lost = 0u;
    while (hal_pulse_take(&pulse)) {
        lost += pulse.lost;
    }
    give(0u);
    TEST_ASSERT_TRUE(hal_pulse_take(&pulse));

    TEST_ASSERT_EQUAL_UINT(UINT8_MAX, lost + pulse.lost);
}

/* ---- starting and stopping ---- */

void test_a_pulse_from_before_the_start_is_not_handed_out(void)
{
    hal_pulse_stop();
    give(0u);
    give(1u);
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_pulse_start(HAL_PULSE_RISING));

    check_nothing_comes();
}

void test_starting_again_drops_what_was_kept(void)
{
    give(0u);
    give(1u);
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_pulse_start(HAL_PULSE_RISING));
    check_nothing_comes();
    give(1u);

    TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
    TEST_ASSERT_EQUAL_UINT8(0u, pulse.lost);
}

void test_after_a_stop_nothing_is_handed_out(void)
{
    give(0u);
    pulse_line_set(1u, true);
    hal_pulse_stop();
    check_nothing_comes();
    pulse_line_set(1u, false);
    give(0u);

    check_nothing_comes();
}

void test_a_line_that_is_high_at_the_start_waits_for_the_next_edge(void)
{
    hal_pulse_stop();
    pulse_line_set(0u, true);
    pulse_line_set(1u, true);
    pulse_lines_pass_us(PULSES.latency_us);
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_pulse_start(HAL_PULSE_RISING));
    check_nothing_comes();
    pulse_line_set(0u, false);
    pulse_lines_pass_us(PULSES.latency_us);
    give(0u);

    TEST_ASSERT_EQUAL_UINT(1u, taken_in_all());
}

void test_falling_edges_are_stamped_if_asked_for(void)
{
    for (uint8_t channel = 0u; channel < HAL_PULSE_CHANNELS; ++channel) {
        TEST_ASSERT_EQUAL_INT(HAL_OK, hal_pulse_start(HAL_PULSE_FALLING));
        pulse_line_set(channel, true);
        check_nothing_comes();
        uint32_t before = hal_clock_now_ticks();
        pulse_line_set(channel, false);
        pulse_lines_pass_us(PULSES.latency_us + 1u);

        TEST_ASSERT_TRUE(hal_pulse_take(&pulse));
        TEST_ASSERT_EQUAL_UINT8(channel, pulse.channel);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency_ticks(),
                                         ticks_elapsed(pulse.captured_ticks, before));
        check_nothing_comes();
    }
}
