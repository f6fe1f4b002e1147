#include "latch_checks.h"

#include "unity.h"

void latch_check_counters(const latch_t *latch, const latch_counters_t *expected)
{
    latch_counters_t counters = latch_counters(latch);
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(expected->bounces, counters.bounces, "bounces");
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(expected->glitches, counters.glitches, "glitches");
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(expected->overruns, counters.overruns, "overruns");
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(expected->unarmed, counters.unarmed, "unarmed");
}

latch_record_t latch_check_take(latch_t *latch)
{
    latch_record_t record = {0};
    TEST_ASSERT_TRUE_MESSAGE(latch_take(latch, &record), "no record to be taken");
    return record;
}

void latch_check_nothing(latch_t *latch)
{
    latch_record_t record;
    TEST_ASSERT_FALSE_MESSAGE(latch_take(latch, &record), "a record that should not be there");
}

void latch_check_record(latch_t *latch, uint32_t ticks, int32_t position_counts, uint8_t flags)
{
    latch_record_t record = latch_check_take(latch);
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(ticks, record.ticks, "ticks");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(position_counts, record.position_counts, "position");
    TEST_ASSERT_EQUAL_HEX8_MESSAGE(flags, record.flags, "flags");
}
