/* hal_edge_events.h: when an edge is delivered, and what time it carries. */
/* LINK: host_sim/tests/port_under_test.c tests/support/edge_log.c $(OUT)/libskiplatch_sim.a */
#include "../contract/port_under_test.h"
#include "edge_log.h"
#include "hal_clock.h"
#include "hal_edge.h"
#include "hal_error.h"
#include "input/ticks.h"
#include "unity.h"

static void arm_all(void)
{
    edge_log_clear();
    for (uint8_t channel = 0u; channel < PORT.channels; ++channel) {
        const hal_edge_config_t config = {.channel = channel};
        TEST_ASSERT_EQUAL_INT(HAL_OK, hal_edge_arm(&config));
    }
}

void setUp(void)
{
    port_power_up();
    arm_all();
}

void tearDown(void)
{
}

static uint32_t latency_ticks(void)
{
    return ticks_from_us(PORT.edge_latency_us, hal_clock_tick_ps()) + 1u;
}

/* An edge now, its release, and what was delivered of it. */
static const edge_log_entry_t *edge_on(uint8_t channel)
{
    unsigned before = edge_log_count();
    port_set_line(channel, true);
    port_pass_us(PORT.edge_latency_us + 1u);
    TEST_ASSERT_EQUAL_UINT(before + 1u, edge_log_count());
    port_set_line(channel, false);
    port_pass_us(PORT.edge_latency_us + 1u);
    return edge_log_entry(before);
}

void test_the_captured_time_is_that_of_the_edge(void)
{
    for (uint32_t i = 0u; i < 1000u; ++i) {
        port_pass_us(i);
        uint32_t                before = hal_clock_now_ticks();
        const edge_log_entry_t *edge = edge_on(0u);

        TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency_ticks(),
                                         ticks_elapsed(edge->captured_ticks, before));
    }
}

void test_the_captured_time_is_not_in_the_future(void)
{
    for (uint32_t i = 0u; i < 100u; ++i) {
        const edge_log_entry_t *edge = edge_on(0u);

        TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency_ticks(),
                                         ticks_elapsed(edge->now_ticks, edge->captured_ticks));
    }
}

void test_the_captured_time_stays_that_of_the_edge_when_nobody_looks(void)
{
    uint32_t                before = hal_clock_now_ticks();
    const edge_log_entry_t *edge = edge_on(0u);
    port_pass_us(100000u);

    TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency_ticks(), ticks_elapsed(edge->captured_ticks, before));
}

void test_the_edge_names_its_channel(void)
{
    for (uint8_t channel = 0u; channel < PORT.channels; ++channel) {
        TEST_ASSERT_EQUAL_UINT8(channel, edge_on(channel)->channel);
    }
}

void test_a_fast_train_of_edges_is_delivered_one_by_one(void)
{
    uint32_t last = edge_on(0u)->captured_ticks;
    for (unsigned i = 1u; i < EDGE_LOG_MAX; ++i) {
        uint32_t captured = edge_on(0u)->captured_ticks;
        TEST_ASSERT_LESS_THAN_UINT32(0x80000000u, ticks_elapsed(captured, last));
        TEST_ASSERT_NOT_EQUAL_UINT32(captured, last);
        last = captured;
    }
}

void test_edges_are_stamped_right_across_the_wrap_of_the_clock(void)
{
    const uint32_t latency = latency_ticks(); /* a division: many edges long on a small chip */
    unsigned       edges = 0u;
    if (!port_power_up_at(UINT32_MAX - 3u * latency - 100u)) {
        TEST_IGNORE_MESSAGE("the clock of this port cannot be set");
    }
    arm_all();
    for (; hal_clock_now_ticks() > 0x80000000u; ++edges) {
        uint32_t before = hal_clock_now_ticks();
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(latency,
                                         ticks_elapsed(edge_on(0u)->captured_ticks, before));
    }
    TEST_ASSERT_GREATER_THAN_UINT(0u, edges);
}
