/*
 * The PLC task: a scan cycle that polls the trigger among its inputs.
 * It sees a touch at the first scan after it, up to one period (and the image delay) late.
 */
#ifndef INPUT_PLC_TASK_H
#define INPUT_PLC_TASK_H

#include <stdbool.h>
#include <stdint.h>

#include "input/latch.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PLC_PERIOD_MIN_US   100u
#define PLC_PERIOD_MAX_US   20000u
#define PLC_IMAGE_DELAY_MAX 7u /* scans */

typedef struct {
    uint8_t  channel;           /* trigger line, 0 … LATCH_CHANNEL_MAX */
    uint8_t  axis;              /* whose position is recorded */
    uint8_t  image_delay_scans; /* age of the input image, 0 … PLC_IMAGE_DELAY_MAX */
    uint16_t period_us;         /* PLC_PERIOD_MIN_US … PLC_PERIOD_MAX_US */
} plc_task_config_t;

/*
 * Owned by the caller. `latch` is public: arm it and take records from it with the latch_
 * functions.
 */
typedef struct {
    latch_t  latch;
    uint32_t period_ticks;
    uint32_t last_scan_ticks;
    uint32_t scans;    /* since the start; wraps */
    uint16_t overruns; /* scans that began more than half a period late; wraps */
    uint8_t  channel;
    uint8_t  axis;
    uint8_t  image_delay_scans;
    uint8_t  image; /* the level at the last eight scans, the newest in bit 0 */
} plc_task_t;

/* Before the first scan. Task. Returns HAL_OK, HAL_ERR_CHANNEL or HAL_ERR_CONFIG. */
int plc_task_start(plc_task_t *task, const plc_task_config_t *config);

/*
 * One scan: read the input image, record an edge, judge the latch. Called every period, task or
 * timer interrupt.
 */
void plc_task_scan(plc_task_t *task);

/*
 * True if a scan would change nothing as long as the line rests and no edge waits to be confirmed:
 * the images it still has to work on all hold one level. Same context as the scan.
 */
bool plc_task_is_settled(const plc_task_t *task);

/*
 * Account for `scans` scans that were left out while the task was settled and the line at rest (a
 * tickless port sleeps through them); the last of them would have begun at `last_scan_ticks`. Same
 * context as the scan.
 */
void plc_task_skip_idle(plc_task_t *task, uint32_t scans, uint32_t last_scan_ticks);

#ifdef __cplusplus
}
#endif

#endif
