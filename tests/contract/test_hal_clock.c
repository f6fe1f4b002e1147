/* hal_clock.h: a counter of constant ticks that wraps and never runs backwards. */
/* LINK: host_sim/tests/port_under_test.c tests/support/edge_log.c $(OUT)/libskiplatch_sim.a */
#include "../contract/port_under_test.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "input/ticks.h"
#include "unity.h"

void setUp(void)
{
    port_power_up();
}

void tearDown(void)
{
}

static void check_passes(uint32_t us)
{
    uint64_t tick_ps = hal_clock_tick_ps();
    uint32_t before = hal_clock_now_ticks();
    port_pass_us(us);
    uint32_t elapsed = ticks_elapsed(hal_clock_now_ticks(), before);
    uint64_t error_ps = PORT.time_error_us * 1000000ull + tick_ps;
    int64_t  off_ps = (int64_t)(elapsed * tick_ps) - (int64_t)(us * 1000000ull);

    TEST_ASSERT_INT64_WITHIN(error_ps, 0, off_ps);
}

void test_a_tick_lasts_between_a_picosecond_and_a_millisecond(void)
{
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(1u, hal_clock_tick_ps());
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(1000000000u, hal_clock_tick_ps());
}

void test_the_length_of_a_tick_is_constant(void)
{
    uint32_t tick_ps = hal_clock_tick_ps();
    for (uint32_t us = 1u; us < 1000000u; us *= 7u) {
        port_pass_us(us);
        TEST_ASSERT_EQUAL_UINT32(tick_ps, hal_clock_tick_ps());
    }
}

void test_the_time_that_passes_is_counted(void)
{
    for (uint32_t us = 1u; us < 1000000u; us = 3u * us + 1u) {
        check_passes(us);
    }
}

void test_without_time_passing_the_clock_does_not_run_away(void)
{
    check_passes(0u);
}

void test_the_clock_never_runs_backwards(void)
{
    uint32_t last = hal_clock_now_ticks();
    for (uint32_t i = 0u; i < 1000u; ++i) {
        port_pass_us(i % 3u);
        uint32_t now = hal_clock_now_ticks();
        TEST_ASSERT_LESS_THAN_UINT32(0x80000000u, ticks_elapsed(now, last));
        last = now;
    }
}

/* Where an overflow of a short timer is pending while it is read. */
void test_the_clock_does_not_run_backwards_where_interrupts_are_masked(void)
{
    for (uint32_t i = 0u; i < 20000u; ++i) {
        hal_critical_state_t saved = hal_critical_enter();
        uint32_t             before = hal_clock_now_ticks();
        uint32_t             after = hal_clock_now_ticks();
        hal_critical_exit(saved);

        TEST_ASSERT_LESS_THAN_UINT32(0x80000000u, ticks_elapsed(after, before));
    }
}

/* Readings across the wrap of 24 bits, interrupts masked. */
static bool runs_backwards(void)
{
    hal_critical_state_t saved = hal_critical_enter();
    uint32_t             last = hal_clock_now_ticks();
    bool                 backwards = false;
    for (uint32_t i = 0u; i < 150u; ++i) {
        uint32_t now = hal_clock_now_ticks();
        backwards = backwards || ticks_elapsed(now, last) >= 0x800000u;
        last = now;
    }
    hal_critical_exit(saved);
    return backwards;
}

/* From starts one tick apart, so that no one phase of the readings decides. */
void test_the_clock_does_not_run_backwards_where_24_bits_wrap(void)
{
    for (uint32_t i = 0u; i < 32u; ++i) {
        if (!port_power_up_at(0x1000000u - 1000u - i)) {
            TEST_IGNORE_MESSAGE("the clock of this port cannot be set");
        }
        TEST_ASSERT_FALSE(runs_backwards());
    }
}

void test_the_clock_wraps_from_its_maximum_to_zero(void)
{
    uint32_t error_ticks = ticks_from_us(PORT.time_error_us, hal_clock_tick_ps());
    if (!port_power_up_at(UINT32_MAX - error_ticks - 10u)) {
        TEST_IGNORE_MESSAGE("the clock of this port cannot be set");
    }
    uint32_t before = hal_clock_now_ticks();
    TEST_ASSERT_GREATER_THAN_UINT32(0x80000000u, before);
    for (uint32_t passed = 0u; hal_clock_now_ticks() > 0x80000000u; ++passed) {
        TEST_ASSERT_LESS_THAN_UINT32(1000u, passed);
        check_passes(1u + PORT.time_error_us / 10u);
    }

    TEST_ASSERT_LESS_THAN_UINT32(1000000u, hal_clock_now_ticks());
}
