#include "report/latch_frame.h"

#include <string.h>

#include "report/latch_crc.h"

#define FLAGS_MASK    0x0Fu
#define CHANNEL_SHIFT 4u
#define CRC_OFFSET    6u

static void put_u32(uint8_t *bytes, uint32_t value)
{
    for (uint8_t i = 0; i < 4u; ++i) {
        bytes[i] = (uint8_t)(value >> (8u * i));
    }
}

static uint32_t get_u32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

static uint16_t get_crc(const uint8_t *frame)
{
    return (uint16_t)((uint32_t)frame[CRC_OFFSET] | (uint32_t)frame[CRC_OFFSET + 1u] << 8);
}

/* Close `frame` with the sum carried on from `crc`, and return that sum. */
static uint16_t put_crc(uint8_t *frame, uint16_t crc)
{
    crc = latch_crc_update(crc, frame, CRC_OFFSET);
    frame[CRC_OFFSET] = (uint8_t)crc;
    frame[CRC_OFFSET + 1u] = (uint8_t)(crc >> 8);
    return crc;
}

static bool is_second(const uint8_t *frame)
{
    return (frame[0] & 1u) != 0u;
}

static void count(uint16_t *counter, uint16_t by)
{
    *counter = (uint16_t)(UINT16_MAX - *counter > by ? *counter + by : UINT16_MAX);
}

void latch_frame_encode(const latch_record_t *record,
                        uint8_t               frames[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES])
{
    uint32_t sequence = record->sequence & LATCH_SEQUENCE_MASK;
    uint32_t flags = record->flags & FLAGS_MASK;
    uint32_t channel = record->channel & LATCH_CHANNEL_MAX;

    frames[0][0] = (uint8_t)(sequence << 1);
    frames[0][1] = (uint8_t)(flags | channel << CHANNEL_SHIFT);
    put_u32(&frames[0][2], record->ticks);
    uint16_t crc = put_crc(frames[0], LATCH_CRC_START);

    frames[1][0] = (uint8_t)(frames[0][0] | 1u);
    frames[1][1] = (uint8_t)(sequence >> 7);
    put_u32(&frames[1][2], (uint32_t)record->position_counts);
    (void)put_crc(frames[1], crc);
}

static bool is_pair(const latch_decoder_t *decoder, const uint8_t *second)
{
    return decoder->has_first && second[0] == (uint8_t)(decoder->first[0] | 1u);
}

bool latch_frame_is_good(const latch_decoder_t *decoder, const uint8_t frame[LATCH_FRAME_BYTES])
{
    uint16_t start = LATCH_CRC_START;
    if (is_second(frame)) {
        if (!is_pair(decoder, frame)) {
            return false;
        }
        start = get_crc(decoder->first);
    }
    return latch_crc_update(start, frame, CRC_OFFSET) == get_crc(frame);
}

static latch_frame_result_t take_first(latch_decoder_t *decoder, const uint8_t *frame)
{
    if (decoder->has_first && memcmp(decoder->first, frame, LATCH_FRAME_BYTES) == 0) {
        count(&decoder->repeated_frames, 1u);
        return LATCH_FRAME_REPEATED;
    }
    if (decoder->has_first) { /* its second half never came */
        count(&decoder->unpaired_frames, 1u);
    }
    memcpy(decoder->first, frame, LATCH_FRAME_BYTES);
    decoder->has_first = true;
    return LATCH_FRAME_PARTIAL;
}

static latch_frame_result_t take_stray_second(latch_decoder_t *decoder, const uint8_t *frame)
{
    if (decoder->any_record && frame[0] == (uint8_t)((uint32_t)decoder->last_sequence << 1 | 1u)) {
        count(&decoder->repeated_frames, 1u);
        return LATCH_FRAME_REPEATED;
    }
    count(&decoder->unpaired_frames, 1u);
    return LATCH_FRAME_UNPAIRED;
}

/*
 * The conversion to a signed number by way of the two's complement, without relying on the
 * compiler.
 */
static int32_t to_signed(uint32_t bits)
{
    return bits <= (uint32_t)INT32_MAX ? (int32_t)bits : -(int32_t)(UINT32_MAX - bits) - 1;
}

static void join(const uint8_t *first, const uint8_t *second, latch_record_t *record)
{
    record->ticks = get_u32(&first[2]);
    record->position_counts = to_signed(get_u32(&second[2]));
    record->sequence = (uint16_t)((uint32_t)second[1] << 7 | (uint32_t)first[0] >> 1);
    record->channel = (uint8_t)(first[1] >> CHANNEL_SHIFT & LATCH_CHANNEL_MAX);
    record->flags = (uint8_t)(first[1] & FLAGS_MASK);
}

/* A record that comes once more has the same sum. */
static bool is_restart(const latch_decoder_t *decoder, const latch_record_t *record, uint16_t crc)
{
    if ((record->flags & LATCH_FLAG_FIRST_LAP) == 0u) {
        return false;
    }
    return !decoder->is_first_lap || record->sequence < decoder->last_sequence ||
           (record->sequence == decoder->last_sequence && crc != decoder->last_crc);
}

/*
 * Seen before, `step` numbers on from the last record. In the first lap, and out of it, a number
 * goes ahead only: there what lies behind is a restart.
 */
static bool is_repeated(const latch_decoder_t *decoder, uint16_t step, uint16_t crc)
{
    if (step == 0u) {
        return crc == decoder->last_crc;
    }
    return !decoder->is_first_lap && step > LATCH_SEQUENCE_MASK - LATCH_REPEATED_MAX;
}

/* Count what lies between the last record and this one; false if it was seen before. */
static bool follow(latch_decoder_t *decoder, const latch_record_t *record, uint16_t crc)
{
    uint16_t step = (uint16_t)(record->sequence - decoder->last_sequence) & LATCH_SEQUENCE_MASK;
    if (is_restart(decoder, record, crc)) {
        count(&decoder->restarts, 1u);
        count(&decoder->lost_records, record->sequence);
        return true;
    }
    if (is_repeated(decoder, step, crc)) {
        count(&decoder->repeated_frames, LATCH_FRAMES_PER_RECORD);
        return false;
    }
    count(&decoder->lost_records, (uint16_t)(step - 1u) & LATCH_SEQUENCE_MASK);
    return true;
}

static latch_frame_result_t take_second(latch_decoder_t *decoder, const uint8_t *frame,
                                        latch_record_t *record)
{
    latch_record_t joined;
    join(decoder->first, frame, &joined);
    decoder->has_first = false;

    if (decoder->any_record && !follow(decoder, &joined, get_crc(frame))) {
        return LATCH_FRAME_REPEATED;
    }
    decoder->any_record = true;
    decoder->is_first_lap = (joined.flags & LATCH_FLAG_FIRST_LAP) != 0u;
    decoder->last_crc = get_crc(frame);
    decoder->last_sequence = joined.sequence;
    *record = joined;
    return LATCH_FRAME_RECORD;
}

latch_frame_result_t latch_frame_decode(latch_decoder_t *decoder,
                                        const uint8_t    frame[LATCH_FRAME_BYTES],
                                        latch_record_t  *record)
{
    if (is_second(frame) && !is_pair(decoder, frame)) {
        return take_stray_second(decoder, frame);
    }
    if (!latch_frame_is_good(decoder, frame)) {
        count(&decoder->damaged_frames, 1u);
        return LATCH_FRAME_DAMAGED;
    }
    return is_second(frame) ? take_second(decoder, frame, record) : take_first(decoder, frame);
}
