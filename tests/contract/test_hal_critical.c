/* hal_critical.h: what no edge may cut in two. */
/* LINK: host_sim/tests/port_under_test.c tests/support/edge_log.c $(OUT)/libskiplatch_sim.a */
#include "../contract/port_under_test.h"
#include "edge_log.h"
#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "hal_edge.h"
#include "hal_error.h"
#include "input/ticks.h"
#include "unity.h"

void setUp(void)
{
    const hal_edge_config_t config = {.channel = 0u};
    port_power_up();
    edge_log_clear();
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_edge_arm(&config));
}

void tearDown(void)
{
}

static void check_edge_after_latency(void)
{
    port_pass_us(PORT.edge_latency_us + 1u);
    TEST_ASSERT_EQUAL_UINT(1u, edge_log_count());
}

void test_an_edge_inside_a_section_is_delivered_after_it(void)
{
    hal_critical_state_t saved = hal_critical_enter();
    port_set_line(0u, true);
    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
    hal_critical_exit(saved);

    check_edge_after_latency();
}

void test_an_inner_section_does_not_end_the_outer_one(void)
{
    hal_critical_state_t outer = hal_critical_enter();
    hal_critical_state_t inner = hal_critical_enter();
    port_set_line(0u, true);
    hal_critical_exit(inner);
    TEST_ASSERT_EQUAL_UINT(0u, edge_log_count());
    hal_critical_exit(outer);

    check_edge_after_latency();
}

void test_edges_come_as_before_once_all_sections_are_over(void)
{
    for (unsigned depth = 0u; depth < 8u; ++depth) {
        hal_critical_state_t saved[8];
        for (unsigned i = 0u; i <= depth; ++i) {
            saved[i] = hal_critical_enter();
        }
        for (unsigned i = depth + 1u; i > 0u; --i) {
            hal_critical_exit(saved[i - 1u]);
        }
        edge_log_clear();
        port_set_line(0u, true);
        check_edge_after_latency();
        port_set_line(0u, false);
        port_pass_us(PORT.edge_latency_us + 1u);
    }
}

void test_clock_level_and_position_can_be_read_inside_a_section(void)
{
    port_place_axis(0u, 4711);
    port_set_line(0u, true);
    port_pass_us(PORT.edge_latency_us + 1u);
    uint32_t before = hal_clock_now_ticks();

    hal_critical_state_t saved = hal_critical_enter();
    uint32_t             now = hal_clock_now_ticks();
    bool                 level = hal_edge_level(0u);
    int32_t              position = hal_axis_position_counts(0u);
    hal_critical_exit(saved);

    TEST_ASSERT_LESS_THAN_UINT32(0x80000000u, ticks_elapsed(now, before));
    TEST_ASSERT_TRUE(level);
    TEST_ASSERT_EQUAL_INT32(4711, position);
}
