/* hal_edge.h: arming, disarming, level, filter and polarity of the trigger line. */
/* LINK: host_sim/tests/port_under_test.c tests/support/edge_log.c $(OUT)/libskiplatch_sim.a */
#include "../contract/port_under_test.h"
#include "edge_log.h"
#include "hal_edge.h"
#include "hal_error.h"
#include "unity.h"

static const hal_edge_config_t PLAIN = {.channel = 0u};
static const hal_edge_config_t INVERTED = {.channel = 0u, .active_low = true};

static hal_edge_config_t filtered; /* with the filter that suits the port */

void setUp(void)
{
    filtered = (hal_edge_config_t){.channel = 0u, .glitch_filter_us = PORT.filter_tried_us};
    port_power_up();
    edge_log_clear();
}

void tearDown(void)
{
}

static void arm(const hal_edge_config_t *config)
{
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_edge_arm(config));
}

/* Set the line and let everything come of it that will. */
static void set(bool high)
{
    port_set_line(0u, high);
    port_pass_us(PORT.edge_latency_us + PORT.filter_tried_us + 1u);
}

static void pulse_us(uint32_t us)
{
    port_set_line(0u, true);
    port_pass_us(us);
    set(false);
}

/* ---- channels ---- */

void test_every_channel_of_the_board_can_be_armed(void)
{
    for (uint8_t channel = 0u; channel < PORT.channels; ++channel) {
        const hal_edge_config_t config = {.channel = channel};
        arm(&config);
    }
}

void test_a_channel_the_board_does_not_have_is_refused(void)
{
    const hal_edge_config_t next = {.channel = PORT.channels};
    const hal_edge_config_t last = {.channel = UINT8_MAX};

    TEST_ASSERT_EQUAL_INT(HAL_ERR_CHANNEL, hal_edge_arm(&next));
    TEST_ASSERT_EQUAL_INT(HAL_ERR_CHANNEL, hal_edge_arm(&last));
}

void test_an_unknown_channel_reads_false(void)
{
    arm(&PLAIN);
    set(true);

    TEST_ASSERT_FALSE(hal_edge_level(PORT.channels));
    TEST_ASSERT_FALSE(hal_edge_level(UINT8_MAX));
}

void test_disarming_an_unknown_channel_leaves_the_others_armed(void)
{
    arm(&PLAIN);
    hal_edge_disarm(PORT.channels);
    set(true);

    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}

/* ---- edges ---- */

void test_a_deflection_is_delivered_once(void)
{
    arm(&PLAIN);
    set(true);
    port_pass_us(10000u);

    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
    TEST_ASSERT_EQUAL_UINT8(0u, edge_log_entry(0u)->channel);
}

void test_a_release_is_not_delivered(void)
{
    arm(&PLAIN);
    set(true);
    edge_log_clear();
    set(false);

    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
}

void test_each_deflection_is_delivered(void)
{
    arm(&PLAIN);
    for (unsigned count = 1u; count <= 10u; ++count) {
        set(true);
        TEST_ASSERT_EQUAL_UINT(count, edge_log_count());
        set(false);
    }
}

void test_a_line_that_is_not_armed_delivers_nothing(void)
{
    set(true);

    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
}

void test_an_edge_from_before_arming_is_not_delivered(void)
{
    set(true);
    set(false);
    arm(&PLAIN);
    port_pass_us(10000u);

    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
}

void test_a_line_deflected_when_it_is_armed_waits_for_the_next_edge(void)
{
    set(true);
    arm(&PLAIN);
    port_pass_us(10000u);
    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());

    set(false);
    set(true);
    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}

void test_after_disarming_nothing_is_delivered(void)
{
    arm(&PLAIN);
    hal_edge_disarm(0u);
    set(true);

    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
}

/* Whether it has been delivered before the call or not at all is up to the port. */
void test_an_edge_on_its_way_is_not_delivered_after_disarming(void)
{
    arm(&PLAIN);
    port_set_line(0u, true);
    hal_edge_disarm(0u);
    unsigned before = edge_log_count();
    port_pass_us(10000u);

    TEST_ASSERT_EQUAL_UINT(before, edge_log_count());
}

void test_an_edge_on_its_way_is_not_delivered_after_arming_again(void)
{
    arm(&PLAIN);
    port_set_line(0u, true);
    unsigned before = edge_log_count();
    arm(&PLAIN);
    port_pass_us(10000u);

    TEST_ASSERT_EQUAL_UINT(before, edge_log_count());
}

void test_an_edge_while_disarmed_does_not_come_up_later(void)
{
    arm(&PLAIN);
    hal_edge_disarm(0u);
    set(true);
    set(false);
    arm(&PLAIN);
    port_pass_us(10000u);

    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
}

void test_arming_twice_delivers_once(void)
{
    arm(&PLAIN);
    arm(&PLAIN);
    set(true);

    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}

/* ---- level ---- */

void test_the_level_follows_the_line(void)
{
    arm(&PLAIN);
    TEST_ASSERT_FALSE(hal_edge_level(0u));
    set(true);
    TEST_ASSERT_TRUE(hal_edge_level(0u));
    set(false);
    TEST_ASSERT_FALSE(hal_edge_level(0u));
}

void test_the_level_can_be_read_without_arming(void)
{
    set(true);
    TEST_ASSERT_TRUE(hal_edge_level(0u));
    set(false);
    TEST_ASSERT_FALSE(hal_edge_level(0u));
}

void test_the_level_can_be_read_after_disarming(void)
{
    arm(&PLAIN);
    set(true);
    hal_edge_disarm(0u);

    TEST_ASSERT_TRUE(hal_edge_level(0u));
}

/* ---- filter ---- */

static void need_filter(void)
{
    if (PORT.filter_max_us < PORT.filter_tried_us) {
        TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, hal_edge_arm(&filtered));
        TEST_IGNORE_MESSAGE("this port has no such filter, and says so");
    }
}

void test_a_pulse_shorter_than_the_filter_is_ignored(void)
{
    need_filter();
    arm(&filtered);
    pulse_us(PORT.filter_tried_us - PORT.time_error_us - 1u);

    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
}

void test_a_pulse_longer_than_the_filter_is_delivered(void)
{
    need_filter();
    arm(&filtered);
    pulse_us(PORT.filter_tried_us + PORT.time_error_us + 1u);

    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}

void test_the_level_is_that_behind_the_filter(void)
{
    need_filter();
    arm(&filtered);
    port_set_line(0u, true);
    port_pass_us(PORT.filter_tried_us - PORT.time_error_us - 1u);
    TEST_ASSERT_FALSE(hal_edge_level(0u));
    port_pass_us(2u * PORT.time_error_us + 2u);

    TEST_ASSERT_TRUE(hal_edge_level(0u));
}

void test_without_a_filter_a_short_pulse_is_delivered(void)
{
    arm(&PLAIN);
    pulse_us(1u);

    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}

void test_arming_again_replaces_the_filter(void)
{
    need_filter();
    arm(&filtered);
    arm(&PLAIN);
    pulse_us(1u);
    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());

    arm(&filtered);
    pulse_us(1u);
    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}

void test_a_filter_longer_than_the_board_has_is_refused(void)
{
    if (PORT.filter_max_us == UINT16_MAX) {
        arm(&(hal_edge_config_t){.channel = 0u, .glitch_filter_us = UINT16_MAX});
        return;
    }
    const hal_edge_config_t config = {.channel = 0u,
                                      .glitch_filter_us = (uint16_t)(PORT.filter_max_us + 1u)};

    TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, hal_edge_arm(&config));
}

/* ---- polarity ---- */

void test_an_inverted_line_is_deflected_while_low_or_refused(void)
{
    if (!PORT.has_active_low) {
        TEST_ASSERT_EQUAL_INT(HAL_ERR_CONFIG, hal_edge_arm(&INVERTED));
        return;
    }
    set(true);
    arm(&INVERTED);
    TEST_ASSERT_FALSE(hal_edge_level(0u));
    set(false);

    TEST_ASSERT_TRUE(hal_edge_level(0u));
    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}
