/*
 * The wiring of this port: the trigger line into the skip input or into a PLC task, each latch as a
 * record to the bus. A byte that comes in chooses the path: 's' skip (as at the start), 'p' PLC.
 */
#include <avr/interrupt.h>
#include <stdbool.h>
#include <stdint.h>

#include "axis.h"
#include "clock.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "report/latch_report.h"
#include "scan.h"
#include "uart_bus.h"

/* Every edge is a touch: what a bench injects does not bounce unless it is told to. */
static const latch_config_t LATCH = {.repeated = true, .confirm_ticks = 0u, .holdoff_ticks = 0u};

static const skip_input_config_t SKIP = {.edge = {.channel = 0u}, .axis = 0u};
static const plc_task_config_t   PLC = {.channel = 0u, .axis = 0u, .period_us = 4000u};

static skip_input_t   skip;
static plc_task_t     plc;
static latch_report_t report;
static bool           is_plc;

/* Interrupt. */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this board has one */
    skip_input_on_edge(&skip, captured_ticks);
}

/* Interrupt. */
void scan_on_period(void)
{
    plc_task_scan(&plc);
}

static void stop_paths(void)
{
    scan_stop();
    skip_input_stop(&skip);
}

static bool start_skip(void)
{
    is_plc = false;
    if (skip_input_start(&skip, &SKIP) != HAL_OK) {
        return false;
    }
    latch_arm(&skip.latch, &LATCH);
    return true;
}

static bool start_plc(void)
{
    is_plc = true;
    if (plc_task_start(&plc, &PLC) != HAL_OK) {
        return false;
    }
    latch_arm(&plc.latch, &LATCH);
    scan_start(PLC.period_us);
    return true;
}

/* Any other byte is ignored. */
static bool obey(uint8_t command)
{
    if (command != 's' && command != 'p') {
        return true;
    }
    stop_paths();
    return command == 's' ? start_skip() : start_plc();
}

static void send_latch(void)
{
    latch_record_t record;
    if (latch_report_poll(&report) && latch_take(is_plc ? &plc.latch : &skip.latch, &record)) {
        (void)latch_report_begin(&report, &record); /* nothing is pending, so it is taken */
        (void)latch_report_poll(&report);
    }
}

/* One round of the task; false if the tables above ask for what the board does not have. */
static bool run_task(void)
{
    uint8_t command = 0u;
    if (bus_take_byte(&command) && !obey(command)) {
        return false;
    }
    if (!is_plc) {
        skip_input_poll(&skip, hal_clock_now_ticks());
    }
    send_latch();
    return true;
}

int main(void)
{
    clock_start(0u);
    axis_start();
    bus_start();
    bool is_well = start_skip();
    sei();
    while (is_well) {
        is_well = run_task();
    }
    return 1;
}
