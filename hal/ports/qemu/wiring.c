#include "wiring.h"

#include <stdint.h>

#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "report/latch_report.h"

#define CHANNEL 0u
#define AXIS    0u

/* Every edge is a touch: what a rig injects does not bounce. */
static const latch_config_t LATCH = {.repeated = true, .confirm_ticks = 0u, .holdoff_ticks = 0u};

static const skip_input_config_t SKIP = {
    .edge = {.channel = CHANNEL, .active_low = false, .glitch_filter_us = 0u},
    .axis = AXIS,
};

static const plc_task_config_t PLC = {
    .channel = CHANNEL,
    .axis = AXIS,
    .image_delay_scans = 0u,
    .period_us = 1000u,
};

static const uint32_t FEEDS_MM_PER_MIN[] = {0u, 100u, 1000u, 3000u};
#define FEEDS (sizeof FEEDS_MM_PER_MIN / sizeof *FEEDS_MM_PER_MIN)

static skip_input_t   skip;
static plc_task_t     plc;
static latch_t       *measuring = &skip.latch;
static latch_report_t report;

/* Interrupt. */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this board has one */
    skip_input_on_edge(&skip, captured_ticks);
}

void wiring_scan(void)
{
    plc_task_scan(&plc);
}

static void measure_with(latch_t *latch)
{
    latch_disarm(measuring);
    measuring = latch;
    latch_arm(measuring, &LATCH);
}

static void run_axis(uint32_t feed)
{
    if (feed < FEEDS) {
        axis_run(FEEDS_MM_PER_MIN[feed]);
    }
}

static void obey(int command)
{
    switch (command) {
    case 's':
        measure_with(&skip.latch);
        break;
    case 'p':
        measure_with(&plc.latch);
        break;
    case 'n':
        latch_disarm(measuring);
        break;
    default:
        run_axis((uint32_t)command - '0');
        break;
    }
}

static void send_latch(void)
{
    latch_record_t record;
    if (latch_report_poll(&report) && latch_take(measuring, &record)) {
        (void)latch_report_begin(&report, &record); /* nothing is pending, so it is taken */
        (void)latch_report_poll(&report);
    }
}

static bool start_inputs(void)
{
    if (plc_task_start(&plc, &PLC) != HAL_OK || skip_input_start(&skip, &SKIP) != HAL_OK) {
        return false;
    }
    scan_start(PLC.period_us); /* the task is whole before its first scan */
    disturbance_start();
    return true;
}

bool wiring_start(void)
{
    board_start();
    return start_inputs();
}

void wiring_round(void)
{
    obey(uart_take_byte());
    skip_input_poll(&skip, hal_clock_now_ticks());
    send_latch();
    disturbance_in_task();
}
