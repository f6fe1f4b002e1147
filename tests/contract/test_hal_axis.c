/* hal_axis.h: the position counter, whole, in any context. */
/* LINK: host_sim/tests/port_under_test.c tests/support/edge_log.c $(OUT)/libskiplatch_sim.a */
#include "../contract/port_under_test.h"
#include "edge_log.h"
#include "hal_axis.h"
#include "hal_edge.h"
#include "hal_error.h"
#include "unity.h"

static const int32_t POSITIONS[] = {
    0, 1, -1, 255, 256, -256, 65535, 65536, -65536, 0x01020304, 0x0FFFFFFF, -0x0FFFFFFF,
};
#define POSITION_COUNT (sizeof POSITIONS / sizeof *POSITIONS)

void setUp(void)
{
    port_power_up();
    edge_log_clear();
}

void tearDown(void)
{
}

void test_the_position_is_where_the_axis_is(void)
{
    for (uint8_t axis = 0u; axis < PORT.axes; ++axis) {
        for (size_t i = 0u; i < POSITION_COUNT; ++i) {
            port_place_axis(axis, POSITIONS[i]);
            TEST_ASSERT_EQUAL_INT32(POSITIONS[i], hal_axis_position_counts(axis));
        }
    }
}

void test_an_axis_at_rest_stays_where_it_is(void)
{
    port_place_axis(0u, -4711);
    port_pass_us(100000u);

    TEST_ASSERT_EQUAL_INT32(-4711, hal_axis_position_counts(0u));
}

void test_the_axes_are_read_apart(void)
{
    for (uint8_t axis = 0u; axis < PORT.axes; ++axis) {
        port_place_axis(axis, 1000 + axis);
    }
    for (uint8_t axis = 0u; axis < PORT.axes; ++axis) {
        TEST_ASSERT_EQUAL_INT32(1000 + axis, hal_axis_position_counts(axis));
    }
}

void test_an_unknown_axis_reads_zero(void)
{
    port_place_axis(0u, 4711);

    TEST_ASSERT_EQUAL_INT32(0, hal_axis_position_counts(PORT.axes));
    TEST_ASSERT_EQUAL_INT32(0, hal_axis_position_counts(UINT8_MAX));
}

void test_the_edge_interrupt_reads_the_position(void)
{
    const hal_edge_config_t config = {.channel = 0u};
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_edge_arm(&config));
    for (unsigned i = 0u; i < POSITION_COUNT; ++i) {
        port_place_axis(0u, POSITIONS[i]);
        port_set_line(0u, true);
        port_pass_us(PORT.edge_latency_us + 1u);
        port_set_line(0u, false);
        port_pass_us(PORT.edge_latency_us + 1u);

        TEST_ASSERT_EQUAL_UINT(i + 1u, edge_log_count());
        TEST_ASSERT_EQUAL_INT32(POSITIONS[i], edge_log_entry(i)->position_counts);
    }
}
