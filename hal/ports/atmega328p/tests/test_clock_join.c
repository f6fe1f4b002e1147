/* clock_join.h of the ATmega328P: a 16-bit capture on both sides of an overflow that is pending. */
#include "../hal/ports/atmega328p/clock_join.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static uint32_t join(uint16_t counted, uint16_t timer_ticks, bool is_pending)
{
    return clock_join_ticks(clock_join_overflows(counted, timer_ticks, is_pending), timer_ticks);
}

/*
 * The time of an edge, looked at while the overflow at `turn` still waits for its interrupt; those
 * before it have been counted.
 */
static uint32_t seen(uint64_t edge, uint64_t looked, uint64_t turn)
{
    bool is_pending = looked >= turn;
    return join((uint16_t)((looked >> 16) - (is_pending ? 1u : 0u)), (uint16_t)edge, is_pending);
}

void test_an_edge_before_a_pending_overflow_belongs_to_the_turn_before(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x0004FFFFu, join(4u, 0xFFFFu, true));
    TEST_ASSERT_EQUAL_HEX32(0x00048000u, join(4u, 0x8000u, true));
}

void test_an_edge_after_a_pending_overflow_belongs_to_the_next_turn(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x00050000u, join(4u, 0x0000u, true));
    TEST_ASSERT_EQUAL_HEX32(0x00057FFFu, join(4u, 0x7FFFu, true));
}

void test_without_a_pending_overflow_the_reading_stands_as_it_is(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x00040000u, join(4u, 0x0000u, false));
    TEST_ASSERT_EQUAL_HEX32(0x0004FFFFu, join(4u, 0xFFFFu, false));
}

void test_the_count_of_overflows_wraps(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x00000001u, join(0xFFFFu, 0x0001u, true));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFu, join(0xFFFFu, 0xFFFFu, true));
}

/* Every edge about an overflow, looked at every while later. */
void test_every_edge_about_an_overflow_keeps_its_time(void)
{
    const uint64_t turn = 7ull << 16;
    for (uint64_t edge = turn - 300u; edge < turn + 300u; ++edge) {
        for (uint64_t late = 0u; late < 0x7000u; late += 1u + late / 2u) {
            TEST_ASSERT_EQUAL_HEX32((uint32_t)edge, seen(edge, edge + late, turn));
        }
    }
}
