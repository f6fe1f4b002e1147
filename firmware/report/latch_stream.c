#include "report/latch_stream.h"

#include <string.h>

bool latch_stream_take(latch_stream_t *stream, uint8_t byte, latch_record_t *record)
{
    stream->bytes[stream->filled] = byte;
    ++stream->filled;
    if (stream->filled < LATCH_FRAME_BYTES) {
        return false;
    }
    if (!latch_frame_is_good(&stream->decoder, stream->bytes)) {
        memmove(stream->bytes, &stream->bytes[1], LATCH_FRAME_BYTES - 1u);
        --stream->filled;
        ++stream->skipped_bytes;
        return false;
    }
    stream->filled = 0u;
    return latch_frame_decode(&stream->decoder, stream->bytes, record) == LATCH_FRAME_RECORD;
}
