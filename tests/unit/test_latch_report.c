/* Numbering records and sending them over a bus that is now and then full. */
/* LINK: firmware/report/latch_report.c firmware/report/latch_frame.c firmware/report/latch_crc.c
 *       tests/support/records.c */
/* MOCK: hal/include/hal_bus.h */
#include <string.h>

#include "hal_error.h"
#include "mock_hal_bus.h"
#include "records.h"
#include "report/latch_report.h"
#include "unity.h"

static latch_report_t  report;
static latch_decoder_t decoder;
static latch_record_t  arrived;
static unsigned        arrived_count;
static unsigned        accepted; /* frames the bus has taken */
static unsigned        calls;
static uint32_t        busy_at; /* bit n: the n-th call, of the first 32, finds the bus full */

/* A bus with a recorder at its other end. */
static int bus_send(const uint8_t *frame, int call_of_stub)
{
    (void)call_of_stub;
    unsigned call = calls++;
    if (call < 32u && (busy_at >> call & 1u) != 0u) {
        return HAL_ERR_BUSY;
    }
    ++accepted;
    if (latch_frame_decode(&decoder, frame, &arrived) == LATCH_FRAME_RECORD) {
        ++arrived_count;
    }
    return HAL_OK;
}

void setUp(void)
{
    report = (latch_report_t){0};
    decoder = (latch_decoder_t){0};
    arrived_count = 0u;
    accepted = 0u;
    calls = 0u;
    busy_at = 0u;
    hal_bus_send_Stub(bus_send);
}

void tearDown(void)
{
}

static bool begin(uint32_t n)
{
    latch_record_t record = record_number(n);
    return latch_report_begin(&report, &record);
}

static void check_arrived(uint32_t n, uint16_t sequence)
{
    latch_record_t expected = record_number(n);
    expected.sequence = sequence;
    expected.flags |= LATCH_FLAG_FIRST_LAP;
    records_check_equal(&expected, &arrived);
}

void test_nothing_is_sent_before_a_record_is_given(void)
{
    TEST_ASSERT_TRUE(latch_report_poll(&report));
    TEST_ASSERT_EQUAL_UINT(0u, accepted);
}

void test_beginning_sends_nothing_yet(void)
{
    TEST_ASSERT_TRUE(begin(1u));
    TEST_ASSERT_EQUAL_UINT(0u, accepted);
}

void test_a_free_bus_takes_both_halves_in_one_poll(void)
{
    (void)begin(1u);

    TEST_ASSERT_TRUE(latch_report_poll(&report));
    TEST_ASSERT_EQUAL_UINT(2u, accepted);
    TEST_ASSERT_EQUAL_UINT(1u, arrived_count);
    check_arrived(1u, 0u);
}

void test_a_sent_record_is_not_sent_again(void)
{
    (void)begin(1u);
    (void)latch_report_poll(&report);

    TEST_ASSERT_TRUE(latch_report_poll(&report));
    TEST_ASSERT_EQUAL_UINT(2u, accepted);
}

void test_records_are_numbered_in_turn_whatever_number_they_came_with(void)
{
    for (uint16_t sequence = 0u; sequence < 10u; ++sequence) {
        TEST_ASSERT_TRUE(begin(100u + sequence));
        (void)latch_report_poll(&report);

        check_arrived(100u + sequence, sequence);
    }
    TEST_ASSERT_EQUAL_UINT16(0u, decoder.lost_records);
}

void test_numbers_wrap_at_their_range(void)
{
    report.sequence = LATCH_SEQUENCE_MASK;
    (void)begin(1u);
    (void)latch_report_poll(&report);
    check_arrived(1u, LATCH_SEQUENCE_MASK);

    (void)begin(2u);
    (void)latch_report_poll(&report);
    TEST_ASSERT_EQUAL_UINT16(0u, arrived.sequence);
    TEST_ASSERT_EQUAL_HEX8(0u, arrived.flags & LATCH_FLAG_FIRST_LAP);
}

void test_a_full_bus_is_tried_again_at_the_next_poll(void)
{
    busy_at = 0x1u;
    (void)begin(1u);

    TEST_ASSERT_FALSE(latch_report_poll(&report));
    TEST_ASSERT_EQUAL_UINT(0u, accepted);
    TEST_ASSERT_TRUE(latch_report_poll(&report));
    check_arrived(1u, 0u);
}

void test_a_bus_that_fills_between_the_halves_gets_the_second_alone_later(void)
{
    busy_at = 0x6u; /* the second half is refused twice */
    (void)begin(1u);

    TEST_ASSERT_FALSE(latch_report_poll(&report));
    TEST_ASSERT_EQUAL_UINT(1u, accepted);
    TEST_ASSERT_FALSE(latch_report_poll(&report));
    TEST_ASSERT_TRUE(latch_report_poll(&report));
    TEST_ASSERT_EQUAL_UINT(2u, accepted);
    check_arrived(1u, 0u);
}

void test_every_pattern_of_refusals_delivers_each_record_once(void)
{
    for (uint32_t pattern = 0u; pattern < 256u; ++pattern) {
        setUp();
        busy_at = pattern;
        for (uint32_t n = 0u; n < 4u; ++n) {
            TEST_ASSERT_TRUE(begin(n));
            while (!latch_report_poll(&report)) {
            }
            check_arrived(n, (uint16_t)n);
        }
        TEST_ASSERT_EQUAL_UINT(4u, arrived_count);
        TEST_ASSERT_EQUAL_UINT(8u, accepted);
    }
}

void test_a_record_on_its_way_out_is_not_replaced(void)
{
    busy_at = 0x2u;
    (void)begin(1u);
    (void)latch_report_poll(&report);

    TEST_ASSERT_FALSE(begin(2u));
    TEST_ASSERT_TRUE(latch_report_poll(&report));
    check_arrived(1u, 0u);
}

void test_a_refused_record_uses_up_no_number(void)
{
    (void)begin(1u);
    (void)begin(2u);
    (void)latch_report_poll(&report);
    (void)begin(3u);
    (void)latch_report_poll(&report);

    check_arrived(3u, 1u);
}

void test_the_callers_record_is_free_again_after_beginning(void)
{
    latch_record_t record = record_number(1u);
    (void)latch_report_begin(&report, &record);
    memset(&record, 0xFF, sizeof record);
    (void)latch_report_poll(&report);

    check_arrived(1u, 0u);
}
