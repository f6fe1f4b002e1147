/* Every record that is encoded comes out of the decoder as it went in, whatever came before. */
/* LINK: firmware/report/latch_frame.c firmware/report/latch_crc.c */
/* CBMC: --unwind 9 */
/* MUTANT: firmware/report/latch_frame.c: (uint8_t)(sequence >> 7) => (uint8_t)(sequence >> 8) */
/* MUTANT: firmware/report/latch_frame.c: -(int32_t)(UINT32_MAX - bits) - 1 => -(int32_t)(UINT32_MAX
 * - bits) */
/* MUTANT: firmware/report/latch_frame.c: channel << CHANNEL_SHIFT) => channel << 3u) */
/* MUTANT: firmware/report/latch_frame.c: (uint8_t)(frames[0][0] | 1u) => frames[0][0] */
/* MUTANT: firmware/report/latch_frame.c: (void)put_crc(frames[1], crc) => (void)put_crc(frames[1],
 * LATCH_CRC_START) */
#include "any.h"
#include "report/latch_frame.h"

static bool is_same(const latch_record_t *a, const latch_record_t *b)
{
    return a->ticks == b->ticks && a->position_counts == b->position_counts &&
           a->sequence == b->sequence && a->channel == b->channel && a->flags == b->flags;
}

int main(void)
{
    latch_record_t sent = {nondet_u32(), nondet_i32(), nondet_u16(), nondet_u8(), nondet_u8()};
    latch_record_t received;
    uint8_t        frames[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES];
    ASSUME(sent.sequence <= LATCH_SEQUENCE_MASK && sent.channel <= LATCH_CHANNEL_MAX);
    ASSUME(sent.flags <= 0x0Fu);
    latch_frame_encode(&sent, frames);

    latch_decoder_t fresh = {0};
    PROVE(latch_frame_decode(&fresh, frames[0], &received) == LATCH_FRAME_PARTIAL);
    PROVE(latch_frame_decode(&fresh, frames[1], &received) == LATCH_FRAME_RECORD);
    PROVE(is_same(&sent, &received));

    latch_decoder_t used;
    ASSUME(used.last_sequence <= LATCH_SEQUENCE_MASK);
    latch_frame_result_t first = latch_frame_decode(&used, frames[0], &received);
    PROVE(first == LATCH_FRAME_PARTIAL || first == LATCH_FRAME_REPEATED);
    latch_frame_result_t second = latch_frame_decode(&used, frames[1], &received);
    PROVE(second == LATCH_FRAME_RECORD || second == LATCH_FRAME_REPEATED);
    PROVE(IMPLIES(second == LATCH_FRAME_RECORD, is_same(&sent, &received)));
    return 0;
}
