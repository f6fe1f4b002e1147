/* Numbers latch records and sends them over the bus, holding back what it cannot take at once. */
#ifndef REPORT_LATCH_REPORT_H
#define REPORT_LATCH_REPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "report/latch_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Start from all zeros. */
typedef struct {
    uint8_t  frames[LATCH_FRAMES_PER_RECORD][LATCH_FRAME_BYTES];
    uint16_t sequence; /* of the next record; the upper bit: it has wrapped since the start */
    uint8_t  pending;  /* frames still to be sent, the last ones of `frames` */
} latch_report_t;

/*
 * Number `record` and begin to send it. False, and nothing happens, while the one before is
 * still on its way out. Task.
 */
bool latch_report_begin(latch_report_t *report, const latch_record_t *record);

/* Hand on what the bus takes now. True once nothing is pending. Task. */
bool latch_report_poll(latch_report_t *report);

#ifdef __cplusplus
}
#endif

#endif
