/*
 * The firmware with grbl's pins and timers: latches the probe's edges on the skip path and sends
 * each as a record over the UART. A byte on the UART says what to do:
 *
 *   s  latch every edge      0        stand
 *   n  latch none            1, 2, 3  run forward at 100, 1000, 3000 mm/min
 */
#include <avr/interrupt.h>
#include <stdbool.h>
#include <stdint.h>

#include "board.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/skip_input.h"
#include "report/latch_report.h"
#include "stepper.h"
#include "uart_bus.h"

/* Every edge is a touch: what a bench injects does not bounce unless it is told to. */
static const latch_config_t LATCH = {.repeated = true, .confirm_ticks = 0u, .holdoff_ticks = 0u};

static const skip_input_config_t SKIP = {
    .edge = {.channel = BOARD_PROBE_CHANNEL, .active_low = false, .glitch_filter_us = 0u},
    .axis = BOARD_AXIS,
};

static const uint16_t FEEDS_MM_PER_MIN[] = {0u, 100u, 1000u, 3000u};
#define FEEDS (sizeof FEEDS_MM_PER_MIN / sizeof *FEEDS_MM_PER_MIN)

static skip_input_t   skip;
static latch_report_t report;

/* Interrupt. */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this board has one */
    skip_input_on_edge(&skip, captured_ticks);
}

static void obey(uint8_t command)
{
    uint8_t feed = (uint8_t)(command - '0');
    if (command == 's') {
        latch_arm(&skip.latch, &LATCH);
    } else if (command == 'n') {
        latch_disarm(&skip.latch);
    } else if (feed < FEEDS) {
        stepper_run(FEEDS_MM_PER_MIN[feed]);
    }
}

static void send_latch(void)
{
    latch_record_t record;
    if (latch_report_poll(&report) && latch_take(&skip.latch, &record)) {
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
    skip_input_poll(&skip, hal_clock_now_ticks());
    send_latch();
}

int main(void)
{
    stepper_start(0u);
    bus_start();
    if (skip_input_start(&skip, &SKIP) != HAL_OK) {
        return 1; /* the table above asks for what the board does not have */
    }
    sei();
    for (;;) {
        run_task();
    }
}
