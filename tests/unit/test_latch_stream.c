/* Frames in a stream of bytes: found at once, and found again after garbage, loss and insertion. */
/* LINK: firmware/report/latch_stream.c firmware/report/latch_frame.c firmware/report/latch_crc.c
 *       tests/support/records.c */
#include <string.h>

#include "records.h"
#include "report/latch_stream.h"
#include "unity.h"

#define RECORD_BYTES (LATCH_FRAMES_PER_RECORD * LATCH_FRAME_BYTES)
#define TAKEN_MAX    8u

static latch_stream_t stream;
static latch_record_t taken[TAKEN_MAX];
static unsigned       taken_count;

void setUp(void)
{
    stream = (latch_stream_t){0};
    taken_count = 0u;
}

void tearDown(void)
{
}

static void feed(const uint8_t *bytes, size_t length)
{
    for (size_t i = 0u; i < length; ++i) {
        if (latch_stream_take(&stream, bytes[i], &taken[taken_count])) {
            ++taken_count;
            TEST_ASSERT_LESS_THAN_UINT(TAKEN_MAX, taken_count);
        }
    }
}

static void bytes_of(uint16_t sequence, uint8_t bytes[RECORD_BYTES])
{
    latch_record_t record = record_in_sequence(sequence);
    uint8_t        frames[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES];
    latch_frame_encode(&record, frames);
    memcpy(bytes, frames, sizeof frames);
}

static void feed_record(uint16_t sequence)
{
    uint8_t bytes[RECORD_BYTES];
    bytes_of(sequence, bytes);
    feed(bytes, sizeof bytes);
}

static void check_taken(unsigned number, uint16_t sequence)
{
    latch_record_t expected = record_in_sequence(sequence);
    TEST_ASSERT_GREATER_THAN_UINT(number, taken_count);
    records_check_equal(&expected, &taken[number]);
}

/* Records 0 and 2 came out whole, record 1 did not and was counted. */
static void check_only_record_1_is_missing(void)
{
    TEST_ASSERT_EQUAL_UINT(2u, taken_count);
    check_taken(0u, 0u);
    check_taken(1u, 2u);
    TEST_ASSERT_EQUAL_UINT16(1u, stream.decoder.lost_records);
}

void test_a_clean_stream_gives_every_record_and_skips_nothing(void)
{
    for (uint16_t sequence = 0u; sequence < 5u; ++sequence) {
        feed_record(sequence);
        check_taken(sequence, sequence);
    }
    TEST_ASSERT_EQUAL_UINT(5u, taken_count);
    TEST_ASSERT_EQUAL_UINT32(0u, stream.skipped_bytes);
}

void test_the_record_comes_with_its_last_byte(void)
{
    uint8_t bytes[RECORD_BYTES];
    bytes_of(0u, bytes);

    feed(bytes, RECORD_BYTES - 1u);
    TEST_ASSERT_EQUAL_UINT(0u, taken_count);
    feed(&bytes[RECORD_BYTES - 1u], 1u);
    TEST_ASSERT_EQUAL_UINT(1u, taken_count);
}

void test_garbage_of_any_length_before_a_record_is_skipped(void)
{
    static const uint8_t garbage[] = {0x00u, 0xFFu, 0x55u, 0xAAu, 0x01u, 0x02u,
                                      0xFEu, 0x7Fu, 0x80u, 0x31u, 0x32u, 0x33u,
                                      0x0Du, 0x0Au, 0x00u, 0x00u, 0x10u, 0xC3u};
    for (size_t length = 0u; length <= sizeof garbage; ++length) {
        setUp();
        feed(garbage, length);
        feed_record(3u);

        check_taken(0u, 3u);
        TEST_ASSERT_EQUAL_UINT32(length, stream.skipped_bytes);
    }
}

void test_a_receiver_that_joins_anywhere_gets_the_next_record(void)
{
    uint8_t bytes[RECORD_BYTES];
    bytes_of(0u, bytes);
    for (size_t missed = 1u; missed < RECORD_BYTES; ++missed) {
        setUp();
        feed(&bytes[missed], RECORD_BYTES - missed);
        feed_record(1u);

        TEST_ASSERT_EQUAL_UINT(1u, taken_count);
        check_taken(0u, 1u);
    }
}

void test_any_lost_byte_costs_one_record(void)
{
    uint8_t bytes[RECORD_BYTES];
    bytes_of(1u, bytes);
    for (size_t lost = 0u; lost < RECORD_BYTES; ++lost) {
        setUp();
        feed_record(0u);
        feed(bytes, lost);
        feed(&bytes[lost + 1u], RECORD_BYTES - lost - 1u);
        feed_record(2u);

        check_only_record_1_is_missing();
    }
}

void test_any_changed_byte_costs_one_record(void)
{
    uint8_t bytes[RECORD_BYTES];
    for (size_t changed = 0u; changed < RECORD_BYTES; ++changed) {
        setUp();
        bytes_of(1u, bytes);
        bytes[changed] = (uint8_t)~bytes[changed];
        feed_record(0u);
        feed(bytes, sizeof bytes);
        feed_record(2u);

        check_only_record_1_is_missing();
    }
}

/* An inserted byte may stand between two frames, and then it costs nothing. */
void test_any_inserted_byte_costs_one_record_at_most(void)
{
    uint8_t bytes[RECORD_BYTES];
    bytes_of(1u, bytes);
    for (size_t place = 0u; place <= RECORD_BYTES; ++place) {
        for (unsigned inserted = 0u; inserted <= UINT8_MAX; ++inserted) {
            uint8_t byte = (uint8_t)inserted;
            setUp();
            feed_record(0u);
            feed(bytes, place);
            feed(&byte, 1u);
            feed(&bytes[place], RECORD_BYTES - place);
            feed_record(2u);

            TEST_ASSERT_EQUAL_UINT(3u, taken_count + stream.decoder.lost_records);
            check_taken(0u, 0u);
            check_taken(taken_count - 1u, 2u);
        }
    }
}

void test_a_byte_inserted_between_frames_costs_nothing(void)
{
    uint8_t bytes[RECORD_BYTES];
    uint8_t byte = 0x5Au;
    bytes_of(1u, bytes);
    feed_record(0u);
    feed(bytes, LATCH_FRAME_BYTES);
    feed(&byte, 1u);
    feed(&bytes[LATCH_FRAME_BYTES], LATCH_FRAME_BYTES);

    TEST_ASSERT_EQUAL_UINT(2u, taken_count);
    check_taken(1u, 1u);
    TEST_ASSERT_EQUAL_UINT32(1u, stream.skipped_bytes);
}

void test_a_record_sent_twice_comes_out_once(void)
{
    feed_record(0u);
    feed_record(0u);
    feed_record(1u);

    TEST_ASSERT_EQUAL_UINT(2u, taken_count);
    check_taken(1u, 1u);
}

void test_the_count_of_skipped_bytes_wraps(void)
{
    uint8_t garbage[LATCH_FRAME_BYTES] = {0};
    stream.skipped_bytes = UINT32_MAX;

    feed(garbage, sizeof garbage);

    TEST_ASSERT_EQUAL_UINT32(0u, stream.skipped_bytes);
}
