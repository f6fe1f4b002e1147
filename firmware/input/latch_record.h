/* What is known of one latched touch: the record that travels from the input to the recorder. */
#ifndef INPUT_LATCH_RECORD_H
#define INPUT_LATCH_RECORD_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Sequence numbers count the records a controller reports, modulo 2^15: a gap is one lost on the
 * way.
 */
#define LATCH_SEQUENCE_MASK 0x7FFFu

/* Channels 0 to 7: the channel travels in three bits. */
#define LATCH_CHANNEL_MAX 7u

#define LATCH_FLAG_PLC     0x01u /* latched by the PLC task; otherwise by the skip input */
#define LATCH_FLAG_BOUNCED 0x02u /* the contact opened and closed again before it was confirmed */
#define LATCH_FLAG_OVERRUN 0x04u /* at least one earlier latch was lost because nobody took it */
/*
 * The sequence numbers have not wrapped since the controller started: record 0 with this flag is
 * the first since a start. latch_report_begin() sets it.
 */
#define LATCH_FLAG_FIRST_LAP 0x08u

typedef struct {
    uint32_t ticks; /* hal_clock ticks of the first edge, or of the scan that saw it; wraps */
    int32_t  position_counts; /* axis position at that instant */
    uint16_t sequence;        /* 0 … LATCH_SEQUENCE_MASK; given when it is reported */
    uint8_t  channel;         /* 0 … LATCH_CHANNEL_MAX */
    uint8_t  flags;           /* LATCH_FLAG_* */
} latch_record_t;

#ifdef __cplusplus
}
#endif

#endif
