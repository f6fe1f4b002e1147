/*
 * The wiring of this port: the trigger line into the skip input and into a PLC task, a touch cycle
 * on one of the two, its record to the bus. Measures one point after another.
 */
#include <stdbool.h>
#include <stdint.h>

#include "cycle/touch_cycle.h"
#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "port.h"
#include "report/latch_report.h"

#define AXIS 0u

/* Which of the two inputs the cycle measures through: &skip.latch or &plc.latch. */
#define MEASURING_LATCH (&skip.latch)

static const skip_input_config_t SKIP = {
    .edge = {.channel = 0u, .active_low = false, .glitch_filter_us = 0u},
    .axis = AXIS,
};

static const plc_task_config_t PLC = {
    .channel = 0u,
    .axis = AXIS,
    .image_delay_scans = 0u,
    .period_us = 4000u,
};

/* At 0.1 µm a count: 5 mm to the surface, 2 mm past it. */
static const touch_config_t CYCLE = {
    .two_touches = true,
    .approach_counts = 50000,
    .overtravel_counts = 20000,
    .back_off_counts = 2500,
    .feed_mm_min = 3000.0,
    .measure_feed_mm_min = 30.0,
    .timeout_us = 60000000u,
    .settle_us = 20000u,
    .confirm_us = 100u,
    .holdoff_us = 10000u,
};

static skip_input_t   skip;
static plc_task_t     plc;
static touch_cycle_t  cycle;
static latch_report_t report;

/* Interrupt. */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this board has one */
    skip_input_on_edge(&skip, captured_ticks);
}

/* Interrupt. */
void port_on_scan(void)
{
    plc_task_scan(&plc);
}

static touch_input_t cycle_input(void)
{
    return (touch_input_t){
        .now_ticks = hal_clock_now_ticks(),
        .position_counts = hal_axis_position_counts(AXIS),
        .is_moving = port_is_moving(),
    };
}

static void carry_out(void)
{
    touch_request_t request;
    if (!touch_cycle_take_request(&cycle, &request)) {
        return;
    }
    if (request.kind == TOUCH_MOVE) {
        port_move(request.target_counts, request.feed_mm_min);
    } else {
        port_stop();
    }
}

static void send_latch(void)
{
    latch_record_t record;
    if (latch_report_poll(&report) && touch_cycle_take_latch(&cycle, &record)) {
        (void)latch_report_begin(&report, &record); /* nothing is pending, so it is taken */
        (void)latch_report_poll(&report);
    }
}

static void start_cycle(void)
{
    touch_input_t input = cycle_input();
    (void)touch_cycle_start(&cycle, MEASURING_LATCH, &CYCLE,
                            &input); /* the error is in the result */
    carry_out();
}

/* One round of the task: input, cycle, motion, report. */
static void run_task(void)
{
    touch_input_t input = cycle_input();
    skip_input_poll(&skip, input.now_ticks);
    touch_state_t state = touch_cycle_poll(&cycle, &input);

    carry_out();
    send_latch();
    if (state == TOUCH_IDLE || state == TOUCH_DONE) { /* after a failure somebody has to look */
        start_cycle();
    }
}

static bool start_inputs(void)
{
    if (plc_task_start(&plc, &PLC) != HAL_OK || skip_input_start(&skip, &SKIP) != HAL_OK) {
        return false;
    }
    port_start_scans(PLC.period_us); /* the task is whole before its first scan */
    return true;
}

int main(void)
{
    port_start();
    if (!start_inputs()) {
        return 1; /* the tables above ask for what the board does not have */
    }
    for (;;) {
        run_task();
    }
}
