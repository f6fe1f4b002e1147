/* The PLC task on a mocked clock, trigger line and axis. */
/* LINK: firmware/input/plc_task.c firmware/input/latch.c
 *       tests/support/fake_critical.c tests/support/latch_checks.c */
/* MOCK: hal/include/hal_clock.h hal/include/hal_edge.h hal/include/hal_axis.h */
#include "epochs.h"
#include "fake_critical.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "latch_checks.h"
#include "mock_hal_axis.h"
#include "mock_hal_clock.h"
#include "mock_hal_edge.h"
#include "unity.h"

#define CHANNEL   6u
#define AXIS      1u
#define TICK_PS   1000000u /* 1 µs, so that ticks read as microseconds */
#define PERIOD_US 4000u
#define LATE_US   6000u /* one and a half periods */

static const latch_config_t ONE_SHOT = {.repeated = false};

static plc_task_t task;
static uint32_t   now;

void setUp(void)
{
    fake_critical_reset(NULL);
    hal_clock_tick_ps_IgnoreAndReturn(TICK_PS);
    now = 0u;
}

void tearDown(void)
{
    fake_critical_verify();
}

static plc_task_config_t config_with(uint16_t period_us, uint8_t image_delay_scans)
{
    return (plc_task_config_t){.channel = CHANNEL,
                               .axis = AXIS,
                               .image_delay_scans = image_delay_scans,
                               .period_us = period_us};
}

/* A task that has just been started, at `at`, with the line at `level`. */
static void start(uint32_t at, uint8_t image_delay_scans, bool level)
{
    plc_task_config_t config = config_with(PERIOD_US, image_delay_scans);
    now = at;
    hal_clock_now_ticks_ExpectAndReturn(now);
    hal_edge_level_ExpectAndReturn(CHANNEL, level);
    TEST_ASSERT_EQUAL_INT(HAL_OK, plc_task_start(&task, &config));
}

static void start_armed(uint32_t at, uint8_t image_delay_scans)
{
    start(at, image_delay_scans, false);
    latch_arm(&task.latch, &ONE_SHOT);
}

static void scan_after(uint32_t us, bool level)
{
    now += us;
    hal_clock_now_ticks_ExpectAndReturn(now);
    hal_edge_level_ExpectAndReturn(CHANNEL, level);
    plc_task_scan(&task);
}

static void scan(bool level)
{
    scan_after(PERIOD_US, level);
}

/* A scan that finds an edge in its image, and so reads the position. */
static void scan_with_edge(bool level, int32_t position_counts)
{
    hal_axis_position_counts_ExpectAndReturn(AXIS, position_counts);
    scan(level);
}

static bool is_line_read;

static bool read_line(uint8_t channel, int calls)
{
    (void)channel;
    (void)calls;
    is_line_read = true;
    return true;
}

static uint32_t read_clock(int calls)
{
    (void)calls;
    TEST_ASSERT_TRUE(is_line_read);
    return now + PERIOD_US;
}

static int start_with(plc_task_config_t config)
{
    hal_clock_now_ticks_IgnoreAndReturn(0u);
    hal_edge_level_IgnoreAndReturn(false);
    return plc_task_start(&task, &config);
}

/* ---- configuration ---- */

void test_periods_from_100_us_to_20_ms_are_accepted(void)
{
    TEST_ASSERT_EQUAL_INT(HAL_OK, start_with(config_with(100u, 0u)));
    TEST_ASSERT_EQUAL_INT(HAL_OK, start_with(config_with(20000u, 0u)));
}

void test_periods_outside_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, start_with(config_with(0u, 0u)));
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, start_with(config_with(99u, 0u)));
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, start_with(config_with(20001u, 0u)));
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, start_with(config_with(UINT16_MAX, 0u)));
}

void test_images_up_to_seven_scans_old_are_accepted(void)
{
    TEST_ASSERT_EQUAL_INT(HAL_OK, start_with(config_with(PERIOD_US, 7u)));
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, start_with(config_with(PERIOD_US, 8u)));
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, start_with(config_with(PERIOD_US, UINT8_MAX)));
}

void test_a_channel_that_does_not_fit_a_record_is_refused(void)
{
    plc_task_config_t config = config_with(PERIOD_US, 0u);
    config.channel = LATCH_CHANNEL_MAX;
    TEST_ASSERT_EQUAL_INT(HAL_OK, start_with(config));

    config.channel = LATCH_CHANNEL_MAX + 1u;
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CHANNEL, start_with(config));
}

/* ---- latching ---- */

void test_the_first_scan_that_sees_the_touch_latches_its_own_time_and_position(void)
{
    FOR_EACH_EPOCH (epoch) {
        start_armed(epoch, 0u);
        scan(false);

        scan_with_edge(true, -4711);

        latch_check_record(&task.latch, epoch + 2u * PERIOD_US, -4711, LATCH_FLAG_PLC);
    }
}

void test_a_line_is_read_before_the_clock_so_that_no_stamp_lies_before_its_edge(void)
{
    start_armed(0u, 0u);
    is_line_read = false;
    hal_edge_level_Stub(read_line);
    hal_clock_now_ticks_Stub(read_clock);
    hal_axis_position_counts_ExpectAndReturn(AXIS, 0);

    plc_task_scan(&task);

    TEST_ASSERT_TRUE(is_line_read);
}

void test_the_record_is_of_the_tasks_channel(void)
{
    start_armed(0u, 0u);

    scan_with_edge(true, 0);

    TEST_ASSERT_EQUAL_UINT8(CHANNEL, latch_check_take(&task.latch).channel);
}

void test_a_level_that_stays_is_one_edge(void)
{
    start_armed(0u, 0u);
    scan_with_edge(true, 1);
    scan(true);
    scan(true);

    (void)latch_check_take(&task.latch);
    latch_check_nothing(&task.latch);
    latch_check_counters(&task.latch, &(latch_counters_t){0});
}

void test_each_rise_of_the_level_is_an_edge(void)
{
    start_armed(0u, 0u);
    for (int32_t touch = 0; touch < 3; ++touch) {
        latch_arm(&task.latch, &ONE_SHOT);
        scan_with_edge(true, touch);

        latch_check_record(&task.latch, now, touch, LATCH_FLAG_PLC);
        scan(false);
    }
}

void test_a_line_deflected_at_the_start_is_no_edge(void)
{
    for (uint8_t delay = 0u; delay <= PLC_IMAGE_DELAY_MAX; ++delay) {
        start(0u, delay, true);
        latch_arm(&task.latch, &ONE_SHOT);
        for (uint32_t i = 0u; i < 10u; ++i) {
            scan(true);
        }

        latch_check_nothing(&task.latch);
        TEST_ASSERT_TRUE(latch_level(&task.latch));
    }
}

void test_a_line_deflected_at_the_start_is_known_before_the_first_scan(void)
{
    for (uint8_t delay = 0u; delay <= PLC_IMAGE_DELAY_MAX; ++delay) {
        start(0u, delay, true);
        TEST_ASSERT_TRUE(latch_level(&task.latch));

        start(0u, delay, false);
        TEST_ASSERT_FALSE(latch_level(&task.latch));
    }
}

void test_an_edge_while_disarmed_is_counted(void)
{
    start(0u, 0u, false);

    scan_with_edge(true, 1);

    latch_check_counters(&task.latch, &(latch_counters_t){.unarmed = 1u});
}

void test_the_scan_confirms_at_its_own_time(void)
{
    start(0xFFFFF000u, 0u, false);
    latch_arm(&task.latch, &(latch_config_t){.confirm_ticks = 2u * PERIOD_US});
    scan_with_edge(true, 9);
    uint32_t edge = now;

    scan(true);
    latch_check_nothing(&task.latch);
    scan(true);
    latch_check_record(&task.latch, edge, 9, LATCH_FLAG_PLC);
}

void test_a_pulse_of_one_scan_is_rejected_by_confirmation(void)
{
    start(0u, 0u, false);
    latch_arm(&task.latch, &(latch_config_t){.confirm_ticks = PERIOD_US});
    scan_with_edge(true, 9);
    scan(false);
    scan(false);

    latch_check_nothing(&task.latch);
    latch_check_counters(&task.latch, &(latch_counters_t){.glitches = 1u});
}

/* ---- the age of the image ---- */

void test_an_old_image_shows_the_touch_that_many_scans_later(void)
{
    for (uint8_t delay = 0u; delay <= PLC_IMAGE_DELAY_MAX; ++delay) {
        start_armed(0xFFFFC000u, delay);
        for (uint8_t i = 0u; i < delay; ++i) {
            scan(true);
            latch_check_nothing(&task.latch);
        }

        scan_with_edge(true, delay);

        latch_check_record(&task.latch, 0xFFFFC000u + (delay + 1u) * PERIOD_US, delay,
                           LATCH_FLAG_PLC);
    }
}

void test_an_old_image_keeps_a_pulse_of_one_scan(void)
{
    for (uint8_t delay = 1u; delay <= PLC_IMAGE_DELAY_MAX; ++delay) {
        start_armed(0u, delay);
        scan(true);
        for (uint8_t i = 1u; i < delay; ++i) {
            scan(false);
        }

        scan_with_edge(false, 3);
        TEST_ASSERT_TRUE(latch_level(&task.latch));
        scan(false);

        TEST_ASSERT_FALSE(latch_level(&task.latch));
        latch_check_record(&task.latch, (delay + 1u) * PERIOD_US, 3, LATCH_FLAG_PLC);
    }
}

/* ---- scans and overruns ---- */

void test_scans_are_counted(void)
{
    start(0u, 0u, false);
    scan(false);
    scan(false);
    scan(false);

    TEST_ASSERT_EQUAL_UINT32(3u, task.scans);
}

void test_a_scan_half_a_period_late_is_in_time_and_a_tick_more_is_an_overrun(void)
{
    FOR_EACH_EPOCH (epoch) {
        start(epoch, 0u, false);

        scan_after(LATE_US, false);
        TEST_ASSERT_EQUAL_UINT16(0u, task.overruns);
        scan_after(LATE_US + 1u, false);
        TEST_ASSERT_EQUAL_UINT16(1u, task.overruns);
    }
}

void test_a_late_scan_is_one_overrun_and_the_next_is_measured_from_it(void)
{
    start(0u, 0u, false);
    scan_after(10u * PERIOD_US, false);
    scan_after(1u, false);
    scan_after(LATE_US, false);

    TEST_ASSERT_EQUAL_UINT16(1u, task.overruns);
}

void test_the_period_is_measured_in_ticks_of_the_clock(void)
{
    hal_clock_tick_ps_StopIgnore();
    hal_clock_tick_ps_IgnoreAndReturn(TICK_PS / 4u);
    start(0u, 0u, false);

    scan_after(4u * LATE_US, false);
    TEST_ASSERT_EQUAL_UINT16(0u, task.overruns);
    scan_after(4u * LATE_US + 1u, false);
    TEST_ASSERT_EQUAL_UINT16(1u, task.overruns);
}

/* ---- leaving scans out ---- */

void test_a_task_at_rest_is_settled_at_either_level(void)
{
    for (uint8_t delay = 0u; delay <= PLC_IMAGE_DELAY_MAX; ++delay) {
        start(0u, delay, false);
        TEST_ASSERT_TRUE(plc_task_is_settled(&task));

        start(0u, delay, true);
        TEST_ASSERT_TRUE(plc_task_is_settled(&task));
    }
}

void test_a_change_is_settled_once_it_has_passed_through_the_image(void)
{
    for (uint8_t delay = 0u; delay <= PLC_IMAGE_DELAY_MAX; ++delay) {
        start(0u, delay, false);
        hal_axis_position_counts_IgnoreAndReturn(0);
        for (uint8_t i = 0u; i < delay; ++i) {
            scan(true);
            TEST_ASSERT_FALSE(plc_task_is_settled(&task));
        }
        scan(true);
        TEST_ASSERT_TRUE(plc_task_is_settled(&task));
    }
}

void test_a_pulse_is_settled_once_it_has_passed_through_the_image(void)
{
    for (uint8_t delay = 1u; delay <= PLC_IMAGE_DELAY_MAX; ++delay) {
        start(0u, delay, true);
        hal_axis_position_counts_IgnoreAndReturn(0);
        scan(false);
        for (uint8_t i = 0u; i < delay; ++i) {
            scan(true);
            TEST_ASSERT_FALSE(plc_task_is_settled(&task));
        }
        scan(true);
        TEST_ASSERT_TRUE(plc_task_is_settled(&task));
    }
}

void test_scans_left_out_are_counted_and_are_no_overrun(void)
{
    FOR_EACH_EPOCH (epoch) {
        start(epoch, 0u, false);
        scan(false);

        plc_task_skip_idle(&task, 999u, now + 999u * PERIOD_US);
        now += 999u * PERIOD_US;
        scan(false);

        TEST_ASSERT_EQUAL_UINT32(1001u, task.scans);
        TEST_ASSERT_EQUAL_UINT16(0u, task.overruns);
    }
}

void test_a_late_scan_after_some_left_out_is_an_overrun(void)
{
    start(0u, 0u, false);
    plc_task_skip_idle(&task, 10u, 10u * PERIOD_US);
    now = 10u * PERIOD_US;

    scan_after(LATE_US + 1u, false);

    TEST_ASSERT_EQUAL_UINT16(1u, task.overruns);
}
