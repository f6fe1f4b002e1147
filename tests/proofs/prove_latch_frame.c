/*
 * The decoder, in any state, given any frame: in bounds, counters only rise and stop at their
 * maximum, and a record comes out only of two halves that fit.
 */
/* LINK: firmware/report/latch_frame.c firmware/report/latch_crc.c */
/* CBMC: --unwind 9 */
/* MUTANT: firmware/report/latch_frame.c: UINT16_MAX - *counter > by => UINT16_MAX - *counter >= 0
 */
/* MUTANT: firmware/report/latch_frame.c: memcpy(decoder->first, frame, LATCH_FRAME_BYTES) =>
 * memcpy(decoder->first, frame, LATCH_FRAME_BYTES + 1u) */
/* MUTANT: firmware/report/latch_frame.c: if (is_second(frame) && !is_pair(decoder, frame)) => if
 * (false) */
/* MUTANT: firmware/report/latch_frame.c: count(&decoder->damaged_frames, 1u); => (void)0; */
/* MUTANT: firmware/report/latch_frame.c: step > LATCH_SEQUENCE_MASK - LATCH_REPEATED_MAX => false
 */
/* MUTANT: firmware/report/latch_frame.c: LATCH_SEQUENCE_MASK - LATCH_REPEATED_MAX =>
 * LATCH_SEQUENCE_MASK / 2u */
/* MUTANT: firmware/report/latch_frame.c: return !decoder->is_first_lap && => return */
/* MUTANT: firmware/report/latch_frame.c: count(&decoder->restarts, 1u); => (void)0; */
#include <string.h>

#include "any.h"
#include "report/latch_frame.h"

static latch_decoder_t any_decoder(void)
{
    latch_decoder_t decoder;
    ASSUME(decoder.last_sequence <= LATCH_SEQUENCE_MASK);
    return decoder;
}

static uint32_t all_counts(const latch_decoder_t *decoder)
{
    return (uint32_t)decoder->lost_records + decoder->damaged_frames + decoder->repeated_frames +
           decoder->unpaired_frames + decoder->restarts;
}

static void prove_rising(const latch_decoder_t *before, const latch_decoder_t *after)
{
    PROVE(after->lost_records >= before->lost_records);
    PROVE(after->damaged_frames >= before->damaged_frames);
    PROVE(after->repeated_frames >= before->repeated_frames);
    PROVE(after->unpaired_frames >= before->unpaired_frames);
    PROVE(after->restarts >= before->restarts);
    PROVE(after->last_sequence <= LATCH_SEQUENCE_MASK);
}

static void prove_counted(const latch_decoder_t *before, const latch_decoder_t *after,
                          latch_frame_result_t result)
{
    PROVE(IMPLIES(result == LATCH_FRAME_DAMAGED && before->damaged_frames < UINT16_MAX,
                  after->damaged_frames == before->damaged_frames + 1u));
    PROVE(IMPLIES(result == LATCH_FRAME_UNPAIRED && before->unpaired_frames < UINT16_MAX,
                  after->unpaired_frames == before->unpaired_frames + 1u));
    PROVE(IMPLIES(
        result == LATCH_FRAME_REPEATED &&
        before->repeated_frames<UINT16_MAX, after->repeated_frames> before->repeated_frames));
    PROVE(IMPLIES(result == LATCH_FRAME_DAMAGED, after->has_first == before->has_first));
}

/* What a record says of itself, and of the one before it. */
static void prove_record(const latch_decoder_t *before, const latch_decoder_t *after,
                         const latch_record_t *record)
{
    uint16_t step = (uint16_t)(record->sequence - before->last_sequence) & LATCH_SEQUENCE_MASK;
    bool     is_restart = after->restarts != before->restarts;

    PROVE(before->has_first && !after->has_first);
    PROVE(record->sequence <= LATCH_SEQUENCE_MASK && record->channel <= LATCH_CHANNEL_MAX);
    PROVE(after->any_record && after->last_sequence == record->sequence);
    PROVE(IMPLIES(before->any_record && before->restarts < UINT16_MAX && !is_restart,
                  before->is_first_lap || step <= LATCH_SEQUENCE_MASK - LATCH_REPEATED_MAX));
    PROVE(IMPLIES(is_restart, (record->flags & LATCH_FLAG_FIRST_LAP) != 0u));
}

/* Nothing good is held back but the last record, and what is a little older. */
static void prove_held_back(const latch_decoder_t *before, const uint8_t *second)
{
    uint16_t sequence = (uint16_t)((uint32_t)second[1] << 7 | (uint32_t)second[0] >> 1);
    uint16_t age = (uint16_t)(before->last_sequence - sequence) & LATCH_SEQUENCE_MASK;
    PROVE(before->any_record && age <= LATCH_REPEATED_MAX);
    PROVE(IMPLIES(before->is_first_lap, age == 0u));
}

int main(void)
{
    latch_decoder_t decoder = any_decoder();
    latch_decoder_t before = decoder;
    latch_record_t  record;
    latch_record_t  untouched = record;
    uint8_t         frame[LATCH_FRAME_BYTES];

    latch_frame_result_t result = latch_frame_decode(&decoder, frame, &record);
    prove_rising(&before, &decoder);
    prove_counted(&before, &decoder, result);
    PROVE(IMPLIES((frame[0] & 1u) != 0u && !before.has_first,
                  result == LATCH_FRAME_UNPAIRED || result == LATCH_FRAME_REPEATED));
    if (result == LATCH_FRAME_REPEATED && before.has_first && !decoder.has_first) {
        prove_held_back(&before, frame);
    }
    if (result == LATCH_FRAME_RECORD) {
        prove_record(&before, &decoder, &record);
    } else {
        PROVE(record.ticks == untouched.ticks && record.sequence == untouched.sequence);
        PROVE(IMPLIES(result == LATCH_FRAME_PARTIAL, decoder.has_first));
        PROVE(IMPLIES(result != LATCH_FRAME_PARTIAL && all_counts(&before) == 0u,
                      all_counts(&decoder) != 0u));
    }
    return 0;
}
