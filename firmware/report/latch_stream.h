/*
 * Finds latch frames in a stream of bytes, as a UART delivers them, and finds them again after a
 * fault.
 */
#ifndef REPORT_LATCH_STREAM_H
#define REPORT_LATCH_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "report/latch_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Start from all zeros. */
typedef struct {
    latch_decoder_t decoder;
    uint32_t        skipped_bytes; /* bytes that belonged to no good frame; wraps */
    uint8_t         bytes[LATCH_FRAME_BYTES];
    uint8_t         filled;
} latch_stream_t;

/* Take one byte. True when it completed a record, which is then in `record`. Task. */
bool latch_stream_take(latch_stream_t *stream, uint8_t byte, latch_record_t *record);

#ifdef __cplusplus
}
#endif

#endif
