#include "records.h"

#include "unity.h"

/* Spread `n` over all bits (the finaliser of MurmurHash3), so that neighbours have nothing in
 * common. */
static uint32_t spread(uint32_t n)
{
    n ^= n >> 16;
    n *= 0x85EBCA6Bu;
    n ^= n >> 13;
    n *= 0xC2B2AE35u;
    return n ^ n >> 16;
}

latch_record_t record_number(uint32_t n)
{
    uint32_t small = spread(3u * n + 2u);
    return (latch_record_t){
        .ticks = spread(3u * n),
        .position_counts = (int32_t)spread(3u * n + 1u),
        .sequence = (uint16_t)(small & LATCH_SEQUENCE_MASK),
        .channel = (uint8_t)(small >> 16 & LATCH_CHANNEL_MAX),
        .flags = (uint8_t)(small >> 24 & 0x07u),
    };
}

latch_record_t record_in_sequence(uint16_t sequence)
{
    latch_record_t record = record_number(sequence);
    record.sequence = sequence;
    return record;
}

void records_check_equal(const latch_record_t *expected, const latch_record_t *actual)
{
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected->ticks, actual->ticks, "ticks");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected->position_counts, actual->position_counts, "position");
    TEST_ASSERT_EQUAL_HEX16_MESSAGE(expected->sequence, actual->sequence, "sequence");
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(expected->channel, actual->channel, "channel");
    TEST_ASSERT_EQUAL_HEX8_MESSAGE(expected->flags, actual->flags, "flags");
}
