#include "input/plc_task.h"

#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_edge.h"
#include "hal_error.h"
#include "input/ticks.h"

int plc_task_start(plc_task_t *task, const plc_task_config_t *config)
{
    if (config->channel > LATCH_CHANNEL_MAX) {
        return HAL_ERR_CHANNEL;
    }
    if (config->period_us < PLC_PERIOD_MIN_US || config->period_us > PLC_PERIOD_MAX_US ||
        config->image_delay_scans > PLC_IMAGE_DELAY_MAX) {
        return HAL_ERR_CONFIG;
    }
    bool level = hal_edge_level(config->channel);
    *task = (plc_task_t){
        .period_ticks = ticks_from_us(config->period_us, hal_clock_tick_ps()),
        .last_scan_ticks = hal_clock_now_ticks(),
        .channel = config->channel,
        .axis = config->axis,
        .image_delay_scans = config->image_delay_scans,
        .image = level ? UINT8_MAX : 0u,
    };
    latch_init(&task->latch, config->channel, LATCH_FLAG_PLC);
    latch_poll(&task->latch, task->last_scan_ticks, level); /* a cycle may begin before a scan */
    return HAL_OK;
}

/* The level in the image that the task works on. */
static bool image_level(const plc_task_t *task)
{
    return ((uint32_t)task->image >> task->image_delay_scans & 1u) != 0u;
}

static void count_overrun(plc_task_t *task, uint32_t now_ticks)
{
    if (ticks_elapsed(now_ticks, task->last_scan_ticks) >
        task->period_ticks + task->period_ticks / 2u) {
        ++task->overruns;
    }
    task->last_scan_ticks = now_ticks;
}

void plc_task_scan(plc_task_t *task)
{
    bool     was_deflected = image_level(task);
    bool     level = hal_edge_level(task->channel);
    uint32_t now_ticks = hal_clock_now_ticks(); /* after the level: no edge is stamped before it */

    ++task->scans;
    count_overrun(task, now_ticks);
    task->image = (uint8_t)((uint32_t)task->image << 1 | (level ? 1u : 0u));

    bool is_deflected = image_level(task);
    if (is_deflected && !was_deflected) {
        latch_on_edge(&task->latch, now_ticks, hal_axis_position_counts(task->axis));
    }
    latch_poll(&task->latch, now_ticks, is_deflected);
}

bool plc_task_is_settled(const plc_task_t *task)
{
    uint32_t in_use = (2u << task->image_delay_scans) - 1u;
    uint32_t image = task->image & in_use;
    return image == 0u || image == in_use;
}

void plc_task_skip_idle(plc_task_t *task, uint32_t scans, uint32_t last_scan_ticks)
{
    task->scans += scans;
    task->last_scan_ticks = last_scan_ticks;
}
