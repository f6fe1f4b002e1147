/* CRC-16/CCITT-FALSE against its check value and a bit-by-bit definition. */
/* LINK: firmware/report/latch_crc.c */
#include "report/latch_crc.h"
#include "unity.h"

#define POLYNOMIAL 0x1021u

static const uint8_t DIGITS[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};

void setUp(void)
{
}

void tearDown(void)
{
}

/* The shift register itself, a bit at a time. */
static uint16_t shift_byte(uint16_t crc, uint8_t byte)
{
    for (int bit = 7; bit >= 0; --bit) {
        unsigned top = crc >> 15 ^ (byte >> bit & 1u);
        crc = (uint16_t)((unsigned)crc << 1 ^ (top ? POLYNOMIAL : 0u));
    }
    return crc;
}

void test_the_check_value_is_the_published_one(void)
{
    TEST_ASSERT_EQUAL_HEX16(0x29B1u, latch_crc_update(LATCH_CRC_START, DIGITS, sizeof DIGITS));
}

void test_no_bytes_leave_the_sum_as_it_was(void)
{
    TEST_ASSERT_EQUAL_HEX16(0x1234u, latch_crc_update(0x1234u, DIGITS, 0u));
}

void test_the_sum_carries_on_over_any_split(void)
{
    for (size_t split = 0u; split <= sizeof DIGITS; ++split) {
        uint16_t crc = latch_crc_update(LATCH_CRC_START, DIGITS, split);
        crc = latch_crc_update(crc, &DIGITS[split], sizeof DIGITS - split);

        TEST_ASSERT_EQUAL_HEX16(0x29B1u, crc);
    }
}

void test_every_byte_after_every_sum_is_what_the_shift_register_gives(void)
{
    for (uint32_t crc = 0u; crc <= UINT16_MAX; ++crc) {
        for (uint32_t byte = 0u; byte <= UINT8_MAX; byte += crc % 251u == 0u ? 1u : 37u) {
            uint8_t  bytes[] = {(uint8_t)byte};
            uint16_t expected = shift_byte((uint16_t)crc, bytes[0]);
            if (expected != latch_crc_update((uint16_t)crc, bytes, 1u)) {
                TEST_FAIL_MESSAGE("differs from the shift register");
            }
        }
    }
}
