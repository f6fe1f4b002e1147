/* A controller that starts anew, at every sequence number: told, and no record is held back. */
/* LINK: firmware/report/latch_report.c firmware/report/latch_frame.c firmware/report/latch_crc.c
 *       tests/support/records.c */
/* MOCK: hal/include/hal_bus.h */
#include <string.h>

#include "hal_error.h"
#include "mock_hal_bus.h"
#include "records.h"
#include "report/latch_report.h"
#include "unity.h"

/* In the emulator of a board a tenth of the gaps of the host: each takes up to 65,500 records. */
#ifdef SUPPORT_TARGET_H
#define GAP_STEP 997u
#else
#define GAP_STEP 97u
#endif

static latch_report_t  report;
static latch_decoder_t decoder;
static latch_record_t  arrived;
static unsigned        arrived_count;
static bool            is_cut; /* what is sent goes nowhere */

static int bus_send(const uint8_t *frame, int call_of_stub)
{
    (void)call_of_stub;
    arrived_count += !is_cut && latch_frame_decode(&decoder, frame, &arrived) == LATCH_FRAME_RECORD;
    return HAL_OK;
}

void setUp(void)
{
    report = (latch_report_t){0};
    decoder = (latch_decoder_t){0};
    arrived_count = 0u;
    is_cut = false;
    hal_bus_send_Stub(bus_send);
}

void tearDown(void)
{
}

static void send(uint32_t n)
{
    latch_record_t record = record_number(n);
    TEST_ASSERT_TRUE(latch_report_begin(&report, &record));
    TEST_ASSERT_TRUE(latch_report_poll(&report));
}

static void reset(void)
{
    report = (latch_report_t){0};
}

/* Records up to number `last`, of which the last one is what counts; `laps` before that. */
static void send_up_to(uint32_t last, uint32_t laps)
{
    setUp();
    report.sequence = (uint16_t)(last | (laps != 0u ? LATCH_SEQUENCE_MASK + 1u : 0u));
    send(last);
}

/* After a reset the first `lost` records go nowhere; the next two arrive. */
static void check_restart(uint32_t last, uint32_t laps, uint32_t lost)
{
    send_up_to(last, laps);
    reset();
    is_cut = true;
    for (uint32_t n = 0u; n < lost; ++n) {
        send(50000u + n);
    }
    is_cut = false;
    send(60000u);
    TEST_ASSERT_EQUAL_UINT16(lost, arrived.sequence);
    send(60001u);

    TEST_ASSERT_EQUAL_UINT(3u, arrived_count);
    TEST_ASSERT_EQUAL_UINT16(1u, decoder.restarts);
    TEST_ASSERT_EQUAL_UINT16(lost, decoder.lost_records);
    TEST_ASSERT_EQUAL_UINT16(0u, decoder.repeated_frames);
}

void test_a_reset_at_every_sequence_number_is_told_and_costs_no_record(void)
{
    for (uint32_t last = 0u; last <= LATCH_SEQUENCE_MASK; ++last) {
        for (uint32_t lost = 0u; lost <= 3u; ++lost) {
            check_restart(last, 1u, lost);
            if (lost <= last) {
                check_restart(last, 0u, lost);
            }
        }
    }
}

/* Of records 0 and 1 nothing is left but the numbers: the restart shows in no record. */
void test_a_restart_is_hidden_while_all_that_it_repeats_is_lost(void)
{
    send_up_to(1u, 0u);
    reset();
    is_cut = true;
    send(50000u);
    send(50001u);
    is_cut = false;
    send(50002u);

    TEST_ASSERT_EQUAL_UINT(2u, arrived_count);
    TEST_ASSERT_EQUAL_UINT16(0u, decoder.restarts);
}

/* The next `lost` records go nowhere, and the one after them arrives. */
static void check_gap(uint32_t lost, uint16_t counted)
{
    is_cut = true;
    for (uint32_t n = 0u; n < lost; ++n) {
        send(50000u + n);
    }
    is_cut = false;
    send(60000u);
    send(60001u);

    TEST_ASSERT_EQUAL_UINT(3u, arrived_count);
    TEST_ASSERT_EQUAL_UINT16(counted, decoder.lost_records);
    TEST_ASSERT_EQUAL_UINT16(0u, decoder.repeated_frames);
}

void test_however_long_a_gap_in_the_first_lap_no_record_is_held_back(void)
{
    for (uint32_t lost = 16000u; lost < 32760u; lost += GAP_STEP) {
        send_up_to(5u, 0u);
        check_gap(lost, (uint16_t)lost);
        send_up_to(5u, 0u);
        reset();
        check_gap(lost, (uint16_t)(lost - 6u));
    }
}

void test_however_long_a_gap_out_of_the_first_lap_no_record_is_held_back(void)
{
    for (uint32_t lost = 32762u; lost < 65500u; lost += GAP_STEP) {
        send_up_to(5u, 0u);
        check_gap(lost, (uint16_t)(lost & LATCH_SEQUENCE_MASK));
    }
}

void test_several_restarts_in_a_row_are_counted(void)
{
    for (uint32_t n = 0u; n < 5u; ++n) {
        reset();
        send(n);
    }
    TEST_ASSERT_EQUAL_UINT(5u, arrived_count);
    TEST_ASSERT_EQUAL_UINT16(4u, decoder.restarts);
}

void test_restarts_stop_at_their_maximum(void)
{
    decoder.restarts = UINT16_MAX;
    for (uint32_t n = 0u; n < 2u; ++n) {
        reset();
        send(n);
    }
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, decoder.restarts);
}

void test_a_wrap_is_no_restart(void)
{
    for (uint32_t n = 0u; n < 3u * (LATCH_SEQUENCE_MASK + 1u); ++n) {
        send(n);
        bool is_first_lap = n <= LATCH_SEQUENCE_MASK;
        TEST_ASSERT_EQUAL(is_first_lap, (arrived.flags & LATCH_FLAG_FIRST_LAP) != 0u);
    }
    TEST_ASSERT_EQUAL_UINT(3u * (LATCH_SEQUENCE_MASK + 1u), arrived_count);
    TEST_ASSERT_EQUAL_UINT16(0u, decoder.restarts);
    TEST_ASSERT_EQUAL_UINT16(0u, decoder.lost_records);
}

/* A bus may bring the whole of a record twice. */
void test_the_same_record_once_more_is_no_restart(void)
{
    uint8_t frames[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES];
    send(1u);
    memcpy(frames, report.frames, sizeof frames);
    (void)bus_send(frames[0], 0);
    (void)bus_send(frames[1], 0);

    TEST_ASSERT_EQUAL_UINT(1u, arrived_count);
    TEST_ASSERT_EQUAL_UINT16(0u, decoder.restarts);
    TEST_ASSERT_EQUAL_UINT16(2u, decoder.repeated_frames);
}
