/* The frame codec: what is sent comes out, what was damaged, lost or mixed up does not. */
/* LINK: firmware/report/latch_frame.c firmware/report/latch_crc.c tests/support/records.c */
#include <string.h>

#include "records.h"
#include "report/latch_crc.h"
#include "report/latch_frame.h"
#include "unity.h"

#define FRAME_BITS (8u * LATCH_FRAME_BYTES)
#define FIRST      0u
#define SECOND     1u

typedef uint8_t pair_t[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES];

static latch_decoder_t decoder;
static latch_record_t  decoded;

void setUp(void)
{
    decoder = (latch_decoder_t){0};
    decoded = (latch_record_t){0};
}

void tearDown(void)
{
}

static latch_frame_result_t feed(const uint8_t *frame)
{
    return latch_frame_decode(&decoder, frame, &decoded);
}

static latch_frame_result_t feed_half(uint16_t sequence, size_t half)
{
    latch_record_t record = record_in_sequence(sequence);
    pair_t         frames;
    latch_frame_encode(&record, frames);
    return feed(frames[half]);
}

/* Both halves; what the second gives. */
static latch_frame_result_t feed_record(const latch_record_t *record)
{
    pair_t frames;
    latch_frame_encode(record, frames);
    TEST_ASSERT_EQUAL(LATCH_FRAME_PARTIAL, feed(frames[FIRST]));
    return feed(frames[SECOND]);
}

static latch_frame_result_t feed_sequence(uint16_t sequence)
{
    latch_record_t record = record_in_sequence(sequence);
    return feed_record(&record);
}

static void check_counts(uint16_t lost, uint16_t damaged, uint16_t repeated, uint16_t unpaired)
{
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(lost, decoder.lost_records, "lost");
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(damaged, decoder.damaged_frames, "damaged");
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(repeated, decoder.repeated_frames, "repeated");
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(unpaired, decoder.unpaired_frames, "unpaired");
}

static void check_round_trip(const latch_record_t *record)
{
    setUp();
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_record(record));
    records_check_equal(record, &decoded);
    check_counts(0u, 0u, 0u, 0u);
}

static void flip(uint8_t *frame, unsigned bit)
{
    frame[bit / 8u] = (uint8_t)(frame[bit / 8u] ^ 1u << bit % 8u);
}

/* ---- what is sent comes out ---- */

void test_the_bytes_are_those_of_the_header(void)
{
    const latch_record_t record = {.ticks = 0x12345678u,
                                   .position_counts = -2,
                                   .sequence = 0x5AC3u,
                                   .channel = 6u,
                                   .flags = LATCH_FLAG_PLC | LATCH_FLAG_OVERRUN};
    static const uint8_t first[] = {0x86u, 0x65u, 0x78u, 0x56u, 0x34u, 0x12u};
    static const uint8_t second[] = {0x87u, 0xB5u, 0xFEu, 0xFFu, 0xFFu, 0xFFu};
    pair_t               frames;

    latch_frame_encode(&record, frames);

    uint16_t crc = latch_crc_update(LATCH_CRC_START, first, sizeof first);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(first, frames[FIRST], sizeof first);
    TEST_ASSERT_EQUAL_HEX8(crc & 0xFFu, frames[FIRST][6]);
    TEST_ASSERT_EQUAL_HEX8(crc >> 8, frames[FIRST][7]);
    crc = latch_crc_update(crc, second, sizeof second);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(second, frames[SECOND], sizeof second);
    TEST_ASSERT_EQUAL_HEX8(crc & 0xFFu, frames[SECOND][6]);
    TEST_ASSERT_EQUAL_HEX8(crc >> 8, frames[SECOND][7]);
}

void test_extremes_come_out_as_they_went_in(void)
{
    static const uint32_t ticks[] = {0u, 1u, 0x7FFFFFFFu, 0x80000000u, UINT32_MAX};
    static const int32_t  positions[] = {INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX};
    static const uint16_t sequences[] = {0u, 0x7Fu, 0x80u, 0x3FFFu, 0x4000u, 0x7FFFu};

    for (unsigned i = 0u; i < 5u * 6u * 6u * 8u * 16u; ++i) {
        const latch_record_t record = {.ticks = ticks[i % 5u],
                                       .position_counts = positions[i / 5u % 6u],
                                       .sequence = sequences[i / 30u % 6u],
                                       .channel = (uint8_t)(i / 180u % 8u),
                                       .flags = (uint8_t)(i / 1440u)};
        check_round_trip(&record);
    }
}

void test_records_of_all_kinds_come_out_as_they_went_in(void)
{
    for (uint32_t n = 0u; n < 10000u; ++n) {
        const latch_record_t record = record_number(n);
        check_round_trip(&record);
    }
}

void test_sequence_and_channel_are_cut_to_their_ranges(void)
{
    latch_record_t record = record_number(1u);
    record.sequence = 0x8001u;
    record.channel = LATCH_CHANNEL_MAX + 1u;

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_record(&record));
    TEST_ASSERT_EQUAL_HEX16(1u, decoded.sequence);
    TEST_ASSERT_EQUAL_UINT8(0u, decoded.channel);
    TEST_ASSERT_EQUAL_HEX8(record.flags, decoded.flags);
}

void test_the_first_record_may_have_any_number(void)
{
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(12345u));
    check_counts(0u, 0u, 0u, 0u);
}

void test_numbers_go_on_across_their_wrap(void)
{
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(0x7FFEu));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(0x7FFFu));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(0u));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(1u));
    check_counts(0u, 0u, 0u, 0u);
}

void test_a_half_alone_writes_no_record(void)
{
    decoded.ticks = 77u;

    TEST_ASSERT_EQUAL(LATCH_FRAME_PARTIAL, feed_half(5u, FIRST));
    TEST_ASSERT_EQUAL_UINT32(77u, decoded.ticks);
}

/* ---- damage ---- */

/* Send record 1 with these bits wrong in one half, between the good records 0 and 2. */
static void check_damage_is_found(uint32_t n, size_t half, unsigned bit, unsigned other_bit)
{
    latch_record_t record = record_number(n);
    pair_t         frames;
    setUp();
    (void)feed_sequence(0u);
    record.sequence = 1u;
    latch_frame_encode(&record, frames);
    flip(frames[half], bit);
    if (other_bit != bit) {
        flip(frames[half], other_bit);
    }

    TEST_ASSERT_NOT_EQUAL(LATCH_FRAME_RECORD, feed(frames[FIRST]));
    TEST_ASSERT_NOT_EQUAL(LATCH_FRAME_RECORD, feed(frames[SECOND]));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(2u));
    TEST_ASSERT_EQUAL_UINT16(1u, decoder.lost_records);
    TEST_ASSERT_GREATER_THAN_UINT16(0u, decoder.damaged_frames + decoder.unpaired_frames);
}

void test_every_wrong_bit_of_either_half_is_found(void)
{
    for (uint32_t n = 0u; n < 100u; ++n) {
        for (unsigned bit = 0u; bit < FRAME_BITS; ++bit) {
            check_damage_is_found(n, FIRST, bit, bit);
            check_damage_is_found(n, SECOND, bit, bit);
        }
    }
}

void test_any_two_wrong_bits_of_either_half_are_found(void)
{
    for (unsigned bit = 0u; bit < FRAME_BITS; ++bit) {
        for (unsigned other = bit + 1u; other < FRAME_BITS; ++other) {
            check_damage_is_found(bit + other, FIRST, bit, other);
            check_damage_is_found(bit + other, SECOND, bit, other);
        }
    }
}

void test_a_damaged_half_counts_as_damaged(void)
{
    pair_t         frames;
    latch_record_t record = record_in_sequence(0u);
    latch_frame_encode(&record, frames);
    flip(frames[FIRST], 20u);
    TEST_ASSERT_EQUAL(LATCH_FRAME_DAMAGED, feed(frames[FIRST]));
    flip(frames[FIRST], 20u);
    (void)feed(frames[FIRST]);
    flip(frames[SECOND], 20u);
    TEST_ASSERT_EQUAL(LATCH_FRAME_DAMAGED, feed(frames[SECOND]));

    check_counts(0u, 2u, 0u, 0u);
}

void test_a_second_half_sent_again_after_damage_completes_the_record(void)
{
    pair_t         frames;
    latch_record_t record = record_in_sequence(0u);
    latch_frame_encode(&record, frames);
    (void)feed(frames[FIRST]);
    flip(frames[SECOND], 33u);
    TEST_ASSERT_EQUAL(LATCH_FRAME_DAMAGED, feed(frames[SECOND]));
    flip(frames[SECOND], 33u);

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed(frames[SECOND]));
    records_check_equal(&record, &decoded);
}

void test_a_frame_of_one_byte_over_is_damaged(void)
{
    for (unsigned byte = 0u; byte <= UINT8_MAX; byte += 2u) {
        uint8_t frame[LATCH_FRAME_BYTES];
        memset(frame, (int)byte, sizeof frame);
        TEST_ASSERT_EQUAL(LATCH_FRAME_DAMAGED, feed(frame));
    }
}

/* ---- good or not, without taking it ---- */

void test_a_first_half_is_good_anywhere(void)
{
    pair_t         frames;
    latch_record_t record = record_in_sequence(7u);
    latch_frame_encode(&record, frames);

    TEST_ASSERT_TRUE(latch_frame_is_good(&decoder, frames[FIRST]));
    (void)feed(frames[FIRST]);
    TEST_ASSERT_TRUE(latch_frame_is_good(&decoder, frames[FIRST]));
    flip(frames[FIRST], 30u);
    TEST_ASSERT_FALSE(latch_frame_is_good(&decoder, frames[FIRST]));
}

void test_a_second_half_is_good_only_behind_its_first(void)
{
    pair_t         frames;
    latch_record_t record = record_in_sequence(7u);
    latch_frame_encode(&record, frames);
    TEST_ASSERT_FALSE(latch_frame_is_good(&decoder, frames[SECOND]));
    (void)feed_half(8u, FIRST);
    TEST_ASSERT_FALSE(latch_frame_is_good(&decoder, frames[SECOND]));

    (void)feed(frames[FIRST]);
    TEST_ASSERT_TRUE(latch_frame_is_good(&decoder, frames[SECOND]));
    (void)feed(frames[SECOND]);
    TEST_ASSERT_FALSE(latch_frame_is_good(&decoder, frames[SECOND]));
}

/* ---- loss ---- */

void test_a_lost_record_is_counted_by_the_next_one(void)
{
    (void)feed_sequence(10u);

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(12u));
    check_counts(1u, 0u, 0u, 0u);
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(16u));
    check_counts(4u, 0u, 0u, 0u);
}

void test_records_lost_at_the_wrap_are_counted(void)
{
    (void)feed_sequence(0x7FFEu);

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(1u));
    check_counts(2u, 0u, 0u, 0u);
}

void test_a_lost_first_half_loses_the_record(void)
{
    (void)feed_sequence(0u);
    TEST_ASSERT_EQUAL(LATCH_FRAME_UNPAIRED, feed_half(1u, SECOND));

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(2u));
    check_counts(1u, 0u, 0u, 1u);
}

void test_a_lost_second_half_loses_the_record(void)
{
    (void)feed_sequence(0u);
    TEST_ASSERT_EQUAL(LATCH_FRAME_PARTIAL, feed_half(1u, FIRST));

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(2u));
    check_counts(1u, 0u, 0u, 1u);
}

void test_up_to_255_numbers_back_is_the_past_and_all_else_is_a_gap(void)
{
    (void)feed_sequence(0x7000u);
    TEST_ASSERT_EQUAL(LATCH_FRAME_REPEATED, feed_sequence(0x7000u - LATCH_REPEATED_MAX));
    check_counts(0u, 0u, 2u, 0u);

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(0x7000u - LATCH_REPEATED_MAX - 1u));
    check_counts(LATCH_SEQUENCE_MASK - LATCH_REPEATED_MAX - 1u, 0u, 2u, 0u);
}

void test_a_whole_lap_that_was_lost_is_counted(void)
{
    (void)feed_sequence(7u);
    latch_record_t record = record_in_sequence(7u);
    ++record.ticks;

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_record(&record));
    check_counts(LATCH_SEQUENCE_MASK, 0u, 0u, 0u);
}

/* Records after `gap` that are lost; how many of the next hundred come out. */
static unsigned count_after(uint16_t gap)
{
    unsigned count = 0u;
    setUp();
    (void)feed_sequence(5u);
    for (uint16_t i = 0u; i < 100u; ++i) {
        count += feed_sequence((6u + gap + i) & LATCH_SEQUENCE_MASK) == LATCH_FRAME_RECORD;
    }
    return count;
}

void test_no_gap_holds_back_what_comes_after_it(void)
{
    for (uint16_t gap = 0u; gap < LATCH_SEQUENCE_MASK - LATCH_REPEATED_MAX; gap += 9u) {
        TEST_ASSERT_EQUAL_UINT(100u, count_after(gap));
        check_counts(gap, 0u, 0u, 0u);
    }
}

/* ---- repetition and disorder ---- */

void test_a_record_sent_twice_comes_out_once(void)
{
    (void)feed_sequence(7u);

    TEST_ASSERT_EQUAL(LATCH_FRAME_REPEATED, feed_sequence(7u));
    check_counts(0u, 0u, 2u, 0u);
}

void test_halves_sent_twice_make_one_record(void)
{
    TEST_ASSERT_EQUAL(LATCH_FRAME_PARTIAL, feed_half(7u, FIRST));
    TEST_ASSERT_EQUAL(LATCH_FRAME_REPEATED, feed_half(7u, FIRST));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_half(7u, SECOND));
    TEST_ASSERT_EQUAL(LATCH_FRAME_REPEATED, feed_half(7u, SECOND));
    check_counts(0u, 0u, 2u, 0u);
}

void test_a_repetition_does_not_disturb_what_comes_next(void)
{
    (void)feed_sequence(7u);
    (void)feed_sequence(7u);

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(8u));
    check_counts(0u, 0u, 2u, 0u);
}

void test_an_old_record_stays_out(void)
{
    (void)feed_sequence(3u);
    (void)feed_sequence(4u);

    TEST_ASSERT_EQUAL(LATCH_FRAME_REPEATED, feed_sequence(3u));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(5u));
    check_counts(0u, 0u, 2u, 0u);
}

void test_swapped_halves_are_no_record(void)
{
    TEST_ASSERT_EQUAL(LATCH_FRAME_UNPAIRED, feed_half(7u, SECOND));
    TEST_ASSERT_EQUAL(LATCH_FRAME_PARTIAL, feed_half(7u, FIRST));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(8u));
    check_counts(0u, 0u, 0u, 2u);
}

void test_swapped_records_give_the_later_one_only(void)
{
    (void)feed_sequence(1u);

    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_sequence(3u));
    TEST_ASSERT_EQUAL(LATCH_FRAME_REPEATED, feed_sequence(2u));
    check_counts(1u, 0u, 2u, 0u);
}

void test_interleaved_records_are_not_mixed(void)
{
    (void)feed_half(1u, FIRST);
    (void)feed_half(2u, FIRST);

    TEST_ASSERT_EQUAL(LATCH_FRAME_UNPAIRED, feed_half(1u, SECOND));
    TEST_ASSERT_EQUAL(LATCH_FRAME_RECORD, feed_half(2u, SECOND));
    check_counts(0u, 0u, 0u, 2u);
}

/* 128 records on, byte 0 is the same again; only the running sum tells the halves apart. */
void test_halves_of_different_records_never_fit(void)
{
    for (uint16_t sequence = 0u; sequence < 1000u; ++sequence) {
        setUp();
        (void)feed_half(sequence, FIRST);

        TEST_ASSERT_EQUAL(LATCH_FRAME_DAMAGED, feed_half((uint16_t)(sequence + 128u), SECOND));
    }
}

/* ---- counters ---- */

void test_counters_stop_at_their_maximum(void)
{
    decoder.lost_records = UINT16_MAX - 1u;
    (void)feed_sequence(0u);
    (void)feed_sequence(2u);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, decoder.lost_records);

    (void)feed_sequence(5u);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, decoder.lost_records);
}

void test_every_counter_stops_at_its_maximum(void)
{
    uint8_t damaged[LATCH_FRAME_BYTES] = {0};
    decoder.damaged_frames = decoder.repeated_frames = decoder.unpaired_frames = UINT16_MAX;
    (void)feed(damaged);
    (void)feed_sequence(0u);
    (void)feed_sequence(0u);
    (void)feed_half(9u, SECOND);

    check_counts(0u, UINT16_MAX, UINT16_MAX, UINT16_MAX);
}
