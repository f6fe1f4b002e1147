/*
 * A latch record as two frames of eight bytes, the same on CAN and on a UART.
 *
 *   byte      0         1               2 … 5                6 … 7
 *   first     2·s       flags, channel  ticks                crc of the record so far
 *   second    2·s + 1   s >> 7          position_counts      crc of the record to its end
 *
 * s is the sequence number; byte 0 therefore counts frames modulo 256. Numbers are little-endian.
 * The CRC runs on from the first frame into the second, so two halves of different records never
 * fit.
 *
 * A controller that starts anew numbers from 0 again. LATCH_FLAG_FIRST_LAP tells its records from
 * old ones, so that nothing that arrives in its first lap is held back. Hidden stays a restart in
 * the first lap of which records 0 to L are all lost, L being the last number that had arrived: the
 * next one counts as following L. Hidden stay, too, a restart whose first lap is lost, and whole
 * laps in a gap.
 */
#ifndef REPORT_LATCH_FRAME_H
#define REPORT_LATCH_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "input/latch_record.h"

#ifdef __cplusplus
extern "C" {
#endif

#define LATCH_FRAME_BYTES       8u
#define LATCH_FRAMES_PER_RECORD 2u

/*
 * A bus, or what hands it on, may bring records once more that are up to so many numbers old. It
 * is also all that a gap can hold back: one that ends so close to a whole lap.
 */
#define LATCH_REPEATED_MAX 255u

typedef enum {
    LATCH_FRAME_PARTIAL,  /* the first half of a record, kept */
    LATCH_FRAME_RECORD,   /* a whole record was put together */
    LATCH_FRAME_DAMAGED,  /* CRC wrong */
    LATCH_FRAME_REPEATED, /* seen before, ignored */
    LATCH_FRAME_UNPAIRED  /* a second half whose first half did not come, ignored */
} latch_frame_result_t;

/* The receiving side. Start from all zeros. Counters stop at their maximum. */
typedef struct {
    uint16_t lost_records;    /* gaps in the sequence of whole records */
    uint16_t damaged_frames;  /* LATCH_FRAME_DAMAGED */
    uint16_t repeated_frames; /* LATCH_FRAME_REPEATED */
    uint16_t unpaired_frames; /* LATCH_FRAME_UNPAIRED */
    uint16_t restarts;        /* the controller has started anew */
    uint16_t last_sequence;   /* of the last whole record, if any_record */
    uint16_t last_crc;        /* of it */
    bool     is_first_lap;    /* LATCH_FLAG_FIRST_LAP of it */
    bool     any_record;
    bool     has_first;                /* `first` waits for its second half */
    uint8_t  first[LATCH_FRAME_BYTES]; /* the last good first half */
} latch_decoder_t;

/* Write `record` as frames. Sequence and channel are cut to their ranges. Any context. */
void latch_frame_encode(const latch_record_t *record,
                        uint8_t               frames[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES]);

/*
 * True if `frame` would be taken as a half of a record: its CRC is right where it stands. Any
 * context.
 */
bool latch_frame_is_good(const latch_decoder_t *decoder, const uint8_t frame[LATCH_FRAME_BYTES]);

/*
 * Take one frame; `record` is written only on LATCH_FRAME_RECORD. A record that is older than the
 * last one by LATCH_REPEATED_MAX at most counts as repeated, and with LATCH_FLAG_FIRST_LAP, however
 * old, as a restart: no bus that carries records lets one overtake another. All else follows. Task.
 */
latch_frame_result_t latch_frame_decode(latch_decoder_t *decoder,
                                        const uint8_t    frame[LATCH_FRAME_BYTES],
                                        latch_record_t  *record);

#ifdef __cplusplus
}
#endif

#endif
