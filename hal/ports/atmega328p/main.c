/*
 * The firmware on the ATmega328P: watches the trigger line on the skip or the PLC path and sends
 * each latch as a record over the UART. A byte on the UART says what to do:
 *
 *   s  latch every edge on the skip path          0  stand
 *   p  the same on the PLC path                   1  run forward at 100 mm/min
 *   n  watch nothing                              2  run forward at 1000 mm/min
 *   c  touch in cycles of two touches, skip path  3  run forward at 3000 mm/min
 */
#include <avr/interrupt.h>
#include <stdbool.h>
#include <stdint.h>

#include "axis.h"
#include "board.h"
#include "clock.h"
#include "cycle/touch_cycle.h"
#include "deferred.h"
#include "disturbance.h"
#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "report/latch_report.h"
#include "scan.h"
#include "uart_bus.h"

#define SCAN_US      2000u
#define FAR_COUNTS   0x40000000
#define SLOW_MM_MIN  100.0
#define FEED_MM_MIN  1000.0
#define RAPID_MM_MIN 3000.0

typedef enum { WATCH_NOTHING, WATCH_SKIP, WATCH_PLC, WATCH_CYCLE } watch_t;

/* Every edge is a touch: what a bench injects does not bounce unless it is told to. */
static const latch_config_t LATCH = {.repeated = true, .confirm_ticks = 0u, .holdoff_ticks = 0u};

static const skip_input_config_t SKIP = {
    .edge = {.channel = BOARD_TRIGGER_CHANNEL, .active_low = false, .glitch_filter_us = 0u},
    .axis = BOARD_AXIS,
};

static const plc_task_config_t PLC = {
    .channel = BOARD_TRIGGER_CHANNEL,
    .axis = BOARD_AXIS,
    .image_delay_scans = 0u,
    .period_us = SCAN_US,
};

/* At 2 µm a count: 2 mm to the surface, 2 mm past it. */
static const touch_config_t CYCLE = {
    .two_touches = true,
    .approach_counts = 1000,
    .overtravel_counts = 1000,
    .back_off_counts = 100,
    .feed_mm_min = FEED_MM_MIN,
    .measure_feed_mm_min = SLOW_MM_MIN,
    .timeout_us = 10000000u,
    .settle_us = 20000u,
    .confirm_us = 100u,
    .holdoff_us = 1000u,
};

static skip_input_t   skip;
static plc_task_t     plc;
static touch_cycle_t  cycle;
static latch_report_t report;
static watch_t        watched;

/* Interrupt. */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this board has one */
    skip_input_on_edge(&skip, captured_ticks);
}

/* Interrupt, not masked. */
void scan_on_time(void)
{
    plc_task_scan(&plc);
    disturbance_in_scan();
}

/* ---- touch cycles ---- */

static touch_input_t cycle_input(void)
{
    return (touch_input_t){
        .now_ticks = hal_clock_now_ticks(),
        .position_counts = hal_axis_position_counts(BOARD_AXIS),
        .is_moving = axis_is_moving(),
    };
}

static void carry_out(void)
{
    touch_request_t request;
    if (!touch_cycle_take_request(&cycle, &request)) {
        return;
    }
    if (request.kind == TOUCH_MOVE) {
        axis_move(request.target_counts, request.feed_mm_min);
    } else {
        axis_stop();
    }
}

static void start_cycle(void)
{
    touch_input_t input = cycle_input();
    (void)touch_cycle_start(&cycle, &skip.latch, &CYCLE, &input); /* the error is in the result */
    carry_out();
}

/* After a failure somebody has to look. */
static void run_cycle(void)
{
    touch_input_t input = cycle_input();
    touch_state_t state = touch_cycle_poll(&cycle, &input);
    carry_out();
    if (state == TOUCH_DONE) {
        start_cycle();
    }
}

/* ---- commands ---- */

static void watch(watch_t what)
{
    latch_disarm(&plc.latch);
    skip_input_stop(&skip);
    watched = what;
    if (what == WATCH_PLC) {
        latch_arm(&plc.latch, &LATCH);
    } else if (what != WATCH_NOTHING) {
        (void)skip_input_start(&skip, &SKIP); /* has worked at the start */
        latch_arm(&skip.latch, &LATCH);
    }
    if (what == WATCH_CYCLE) {
        start_cycle();
    }
}

static void run_forward(double feed_mm_min)
{
    axis_move(hal_axis_position_counts(BOARD_AXIS) + FAR_COUNTS, feed_mm_min);
}

static void obey(uint8_t command)
{
    switch (command) {
    case 's':
        watch(WATCH_SKIP);
        break;
    case 'p':
        watch(WATCH_PLC);
        break;
    case 'n':
        watch(WATCH_NOTHING);
        break;
    case 'c':
        watch(WATCH_CYCLE);
        break;
    case '1':
        run_forward(SLOW_MM_MIN);
        break;
    case '2':
        run_forward(FEED_MM_MIN);
        break;
    case '3':
        run_forward(RAPID_MM_MIN);
        break;
    default:
        axis_stop();
        break;
    }
}

/* ---- the task ---- */

static bool take_latch(latch_record_t *record)
{
    switch (watched) {
    case WATCH_SKIP:
        return latch_take(&skip.latch, record);
    case WATCH_PLC:
        return latch_take(&plc.latch, record);
    case WATCH_CYCLE:
        return touch_cycle_take_latch(&cycle, record);
    case WATCH_NOTHING:
    default:
        return false;
    }
}

static void send_latch(void)
{
    latch_record_t record;
    if (latch_report_poll(&report) && take_latch(&record)) {
        (void)latch_report_begin(&report, &record); /* nothing is pending, so it is taken */
        (void)latch_report_poll(&report);
    }
}

static void run_task(void)
{
    uint8_t command;
    if (bus_take_byte(&command)) {
        obey(command);
    }
    if (watched != WATCH_PLC) {
        skip_input_poll(&skip, hal_clock_now_ticks());
    }
    if (watched == WATCH_CYCLE) {
        run_cycle();
    }
    send_latch();
    disturbance_in_task();
}

static bool start(void)
{
    clock_start();
    deferred_start();
    axis_start();
    bus_start();
    disturbance_start();
    bool is_good = plc_task_start(&plc, &PLC) == HAL_OK &&
                   skip_input_start(&skip, &SKIP) == HAL_OK && scan_start(SCAN_US) == HAL_OK;
    watch(WATCH_NOTHING);
    sei();
    return is_good;
}

int main(void)
{
    if (!start()) {
        return 1; /* the tables above ask for what the board does not have */
    }
    for (;;) {
        run_task();
    }
}
