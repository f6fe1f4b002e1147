#include "report/latch_report.h"

#include "hal_bus.h"
#include "hal_error.h"

bool latch_report_begin(latch_report_t *report, const latch_record_t *record)
{
    if (report->pending != 0u) {
        return false;
    }
    latch_record_t numbered = *record;
    numbered.sequence = report->sequence;
    report->sequence = (uint16_t)((report->sequence + 1u) & LATCH_SEQUENCE_MASK);
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
