/* What a cycle does not hand on is told: records that nobody took, edges as the travel ends. */
/* LINK: firmware/cycle/touch_cycle*.c firmware/input/latch.c
 *       tests/support/cycle_bench.c tests/support/fake_critical.c */
/* MOCK: hal/include/hal_clock.h */
#include "cycle_bench.h"
#include "fake_critical.h"
#include "mock_hal_clock.h"
#include "unity.h"

#define SECTIONS_MAX 16u /* more than any call below has */
#define CONFIRM      200u

static cycle_bench_t bench;
static unsigned      sections_before; /* the edge comes after the next section but so many */
static bool          is_edge_due;

void setUp(void)
{
    fake_critical_reset(NULL);
    hal_clock_tick_ps_IgnoreAndReturn(BENCH_TICK_PS);
    is_edge_due = false;
}

void tearDown(void)
{
    fake_critical_verify();
}

static uint16_t overruns(void)
{
    return latch_counters(&bench.latch).overruns;
}

/* ---- the end of the travel ---- */

static void come_due(void)
{
    if (is_edge_due && sections_before-- == 0u) {
        is_edge_due = false;
        bench_touch(&bench, BENCH_END);
    }
}

static void rest_at_the_end(unsigned sections)
{
    touch_config_t config = BENCH_ONE_TOUCH;
    config.confirm_us = CONFIRM;
    fake_critical_reset(NULL);
    bench_set_going(&bench, 1000u, &config);
    (void)bench_poll(&bench);
    bench.input.position_counts = BENCH_END;
    bench.input.is_moving = false;
    fake_critical_reset(come_due);
    sections_before = sections;
    is_edge_due = true;
}

void test_an_edge_as_the_travel_ends_is_a_touch_or_counted(void)
{
    for (unsigned sections = 0u; sections < SECTIONS_MAX; ++sections) {
        rest_at_the_end(sections);
        (void)touch_cycle_poll(&bench.cycle, &bench.input);
        if (!is_edge_due) { /* else there are fewer sections */
            bench_pass(&bench, CONFIRM);
            bool is_touch = bench_poll(&bench) == TOUCH_MEASURED;
            TEST_ASSERT_TRUE(is_touch || latch_counters(&bench.latch).unarmed == 1u);
        }
    }
}

/* ---- records that nobody took ---- */

static void measure(const touch_config_t *config)
{
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, config));
    bench_carry_out(&bench);
    bench_retreat(&bench);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    (void)bench_rest(&bench, BENCH_START);
}

static void measure_once(void)
{
    measure(&BENCH_ONE_TOUCH);
    TEST_ASSERT_EQUAL(TOUCH_DONE, bench.cycle.state);
}

static void measure_twice(void)
{
    measure(&BENCH_TWO_TOUCHES);
    bench_carry_out(&bench);
    bench_retreat(&bench);
    bench_release_and_poll(&bench);
    bench_pass(&bench, BENCH_HOLDOFF);
    TEST_ASSERT_EQUAL(TOUCH_DONE, bench_rest(&bench, BENCH_START));
}

static uint8_t taken_flags(void)
{
    latch_record_t record = {.flags = UINT8_MAX};
    TEST_ASSERT_TRUE(touch_cycle_take_latch(&bench.cycle, &record));
    return record.flags & LATCH_FLAG_OVERRUN;
}

void test_a_record_that_nobody_took_is_counted_and_flagged_once(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    measure_once();
    measure_once();

    TEST_ASSERT_EQUAL_UINT16(1u, overruns());
    TEST_ASSERT_EQUAL_HEX8(LATCH_FLAG_OVERRUN, taken_flags());
    measure_once();
    TEST_ASSERT_EQUAL_HEX8(0u, taken_flags());
    TEST_ASSERT_EQUAL_UINT16(1u, overruns());
}

void test_every_record_lost_in_a_row_is_counted(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    for (unsigned cycle = 0u; cycle < 4u; ++cycle) {
        measure_once();
    }

    TEST_ASSERT_EQUAL_UINT16(3u, overruns());
    TEST_ASSERT_EQUAL_HEX8(LATCH_FLAG_OVERRUN, taken_flags());
}

void test_the_measuring_touch_tells_of_a_loss_that_the_fast_one_was_flagged_with(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    measure_once();
    measure_twice();

    TEST_ASSERT_EQUAL_UINT16(1u, overruns());
    TEST_ASSERT_EQUAL_HEX8(LATCH_FLAG_OVERRUN, taken_flags());
}

void test_a_loss_is_told_across_a_cycle_that_fails(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    measure_once();
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_TWO_TOUCHES));
    bench_carry_out(&bench);
    bench_touch_surface(&bench);
    bench_pass(&bench, BENCH_TIMEOUT);
    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench));
    bench_carry_out(&bench);
    bench_release(&bench);
    (void)bench_rest(&bench, BENCH_START);

    measure_once();

    TEST_ASSERT_EQUAL_HEX8(LATCH_FLAG_OVERRUN, taken_flags());
}

/* ---- motions that nobody began ---- */

void test_a_cycle_that_fails_takes_back_a_motion_that_nobody_began(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_ONE_TOUCH));

    TEST_ASSERT_EQUAL(TOUCH_FAILED, bench_poll(&bench)); /* it stands: nobody took the request */

    bench_check_failed(&bench, TOUCH_ERR_NO_TOUCH, false);
}

/* ---- an input started again ---- */

void test_an_input_that_was_started_again_was_not_touched(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    bench_touch(&bench, BENCH_START);
    bench_release(&bench);
    TEST_ASSERT_EQUAL(TOUCH_ERR_UNARMED_TOUCH, bench_start(&bench, &BENCH_ONE_TOUCH));

    latch_init(&bench.latch, 0u, 0u);

    TEST_ASSERT_EQUAL(TOUCH_OK, bench_start(&bench, &BENCH_ONE_TOUCH));
}

void test_an_input_that_was_started_again_tells_of_touches_after_that(void)
{
    bench_set_up(&bench, 1000u, BENCH_START);
    bench_touch(&bench, BENCH_START);
    bench_release(&bench);
    (void)bench_start(&bench, &BENCH_ONE_TOUCH);

    latch_init(&bench.latch, 0u, 0u);
    bench_touch(&bench, BENCH_START);
    bench_release(&bench);

    TEST_ASSERT_EQUAL(TOUCH_ERR_UNARMED_TOUCH, bench_start(&bench, &BENCH_ONE_TOUCH));
}
