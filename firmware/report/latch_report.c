#include "report/latch_report.h"

#include "hal_bus.h"
#include "hal_error.h"

#define WRAPPED (LATCH_SEQUENCE_MASK + 1u)

bool latch_report_begin(latch_report_t *report, const latch_record_t *record)
{
    if (report->pending != 0u) {
        return false;
    }
    latch_record_t numbered = *record;
    numbered.sequence = report->sequence & LATCH_SEQUENCE_MASK;
    numbered.flags &= (uint8_t)~LATCH_FLAG_FIRST_LAP;
    if ((report->sequence & WRAPPED) == 0u) {
        numbered.flags |= LATCH_FLAG_FIRST_LAP;
    }
    report->sequence = (uint16_t)((report->sequence + 1u) | (report->sequence & WRAPPED));
    latch_frame_encode(&numbered, report->frames);
    report->pending = LATCH_FRAMES_PER_RECORD;
    return true;
}

bool latch_report_poll(latch_report_t *report)
{
    while (report->pending != 0u) {
        if (hal_bus_send(report->frames[LATCH_FRAMES_PER_RECORD - report->pending]) != HAL_OK) {
            return false;
        }
        --report->pending;
    }
    return true;
}
