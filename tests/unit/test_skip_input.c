/* The skip input on a mocked trigger line and axis. */
/* LINK: firmware/input/skip_input.c firmware/input/latch.c
 *       tests/support/fake_critical.c tests/support/latch_checks.c */
/* MOCK: hal/include/hal_edge.h hal/include/hal_axis.h */
#include "fake_critical.h"
#include "hal_error.h"
#include "input/skip_input.h"
#include "latch_checks.h"
#include "mock_hal_axis.h"
#include "mock_hal_edge.h"
#include "unity.h"

#define CHANNEL 3u
#define AXIS    2u

static const skip_input_config_t CONFIG = {
    .edge = {.channel = CHANNEL, .active_low = true, .glitch_filter_us = 17u}, .axis = AXIS};
static const latch_config_t ONE_SHOT = {.repeated = false};

static skip_input_t input;

void setUp(void)
{
    fake_critical_reset(NULL);
}

void tearDown(void)
{
    fake_critical_verify();
}

static void start(void)
{
    hal_edge_arm_IgnoreAndReturn(HAL_OK);
    hal_edge_level_ExpectAndReturn(CHANNEL, false);
    TEST_ASSERT_EQUAL_INT(HAL_OK, skip_input_start(&input, &CONFIG));
}

static void start_armed(void)
{
    start();
    latch_arm(&input.latch, &ONE_SHOT);
}

/* A port that delivers an edge as soon as it watches the line. */
static int arm_with_an_edge(const hal_edge_config_t *config, int calls)
{
    (void)config;
    (void)calls;
    skip_input_on_edge(&input, 42u);
    return HAL_OK;
}

void test_starting_watches_the_line_as_configured(void)
{
    hal_edge_arm_ExpectAndReturn(&CONFIG.edge, HAL_OK);
    hal_edge_level_ExpectAndReturn(CHANNEL, false);

    TEST_ASSERT_EQUAL_INT(HAL_OK, skip_input_start(&input, &CONFIG));
}

void test_the_error_of_the_port_is_handed_on(void)
{
    hal_edge_arm_ExpectAndReturn(&CONFIG.edge, HAL_ERR_CONFIG);

    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, skip_input_start(&input, &CONFIG));
}

void test_the_last_channel_that_fits_a_record_is_accepted(void)
{
    skip_input_config_t config = CONFIG;
    config.edge.channel = LATCH_CHANNEL_MAX;
    hal_edge_arm_ExpectAndReturn(&config.edge, HAL_OK);
    hal_edge_level_ExpectAndReturn(LATCH_CHANNEL_MAX, false);

    TEST_ASSERT_EQUAL_INT(HAL_OK, skip_input_start(&input, &config));
}

void test_a_channel_that_does_not_fit_a_record_is_refused_before_the_port_is_asked(void)
{
    skip_input_config_t config = CONFIG;
    config.edge.channel = LATCH_CHANNEL_MAX + 1u;

    TEST_ASSERT_EQUAL_INT(HAL_ERR_CHANNEL, skip_input_start(&input, &config));
}

void test_after_the_start_the_latch_is_not_armed(void)
{
    start();
    hal_axis_position_counts_IgnoreAndReturn(1);

    skip_input_on_edge(&input, 42u);

    latch_check_nothing(&input.latch);
    latch_check_counters(&input.latch, &(latch_counters_t){.unarmed = 1u});
}

void test_an_edge_that_comes_while_the_port_is_being_armed_is_counted(void)
{
    start_armed();
    hal_axis_position_counts_IgnoreAndReturn(1);
    hal_edge_arm_Stub(arm_with_an_edge);
    hal_edge_level_IgnoreAndReturn(false);

    (void)skip_input_start(&input, &CONFIG);

    latch_check_nothing(&input.latch);
    latch_check_counters(&input.latch, &(latch_counters_t){.unarmed = 1u});
}

void test_a_probe_deflected_at_the_start_is_known_before_the_first_poll(void)
{
    hal_edge_arm_IgnoreAndReturn(HAL_OK);
    hal_edge_level_ExpectAndReturn(CHANNEL, true);

    TEST_ASSERT_EQUAL_INT(HAL_OK, skip_input_start(&input, &CONFIG));

    TEST_ASSERT_TRUE(latch_level(&input.latch));
}

void test_an_edge_latches_the_captured_time_and_the_position_of_its_axis(void)
{
    start_armed();
    hal_axis_position_counts_ExpectAndReturn(AXIS, -98765);

    skip_input_on_edge(&input, 0xFFFFFFFFu);

    latch_check_record(&input.latch, 0xFFFFFFFFu, -98765, 0u);
}

void test_the_record_is_of_the_inputs_channel(void)
{
    start_armed();
    hal_axis_position_counts_IgnoreAndReturn(0);

    skip_input_on_edge(&input, 42u);

    TEST_ASSERT_EQUAL_UINT8(CHANNEL, latch_check_take(&input.latch).channel);
}

void test_a_poll_hands_the_lines_level_to_the_latch(void)
{
    start();

    hal_edge_level_ExpectAndReturn(CHANNEL, true);
    skip_input_poll(&input, 10u);
    TEST_ASSERT_TRUE(latch_level(&input.latch));

    hal_edge_level_ExpectAndReturn(CHANNEL, false);
    skip_input_poll(&input, 20u);
    TEST_ASSERT_FALSE(latch_level(&input.latch));
}

void test_a_poll_confirms_at_its_own_time(void)
{
    start();
    latch_arm(&input.latch, &(latch_config_t){.confirm_ticks = 100u});
    hal_axis_position_counts_ExpectAndReturn(AXIS, 5);
    skip_input_on_edge(&input, 0xFFFFFFF0u);
    hal_edge_level_IgnoreAndReturn(true);

    skip_input_poll(&input, 0xFFFFFFF0u + 99u);
    latch_check_nothing(&input.latch);
    skip_input_poll(&input, 0xFFFFFFF0u + 100u);
    latch_check_record(&input.latch, 0xFFFFFFF0u, 5, 0u);
}

void test_stopping_watches_the_line_no_longer(void)
{
    start();
    hal_edge_disarm_Expect(CHANNEL);

    skip_input_stop(&input);
}

void test_a_stopped_input_still_gives_its_record_and_takes_no_more(void)
{
    start();
    latch_arm(&input.latch, &(latch_config_t){.repeated = true});
    hal_axis_position_counts_IgnoreAndReturn(5);
    skip_input_on_edge(&input, 42u);
    hal_edge_disarm_Ignore();

    skip_input_stop(&input);
    skip_input_on_edge(&input, 43u);

    latch_check_record(&input.latch, 42u, 5, 0u);
    latch_check_nothing(&input.latch);
    latch_check_counters(&input.latch, &(latch_counters_t){.unarmed = 1u});
}
