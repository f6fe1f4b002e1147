/*
 * The wiring of the build `two_cores`, in place of hal/ports/qemu/wiring.c. Core 1 has the skip
 * input and nothing else: no interrupt but its edge. Core 0 has the commands, the axis, the PLC
 * task and the reports, and sends word when the skip input is to be armed. A record comes back as
 * the words that it is made of.
 *
 * What both cores look at is one word each: the axis's count, the timer, the offset of its ticks.
 */
#include "board.h"

#if BOARD_EDGE_CORE == 1u

#include <stdint.h>
#include <string.h>

#include "core1.h"
#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "report/latch_report.h"
#include "wiring.h"

#define CHANNEL 0u
#define AXIS    0u

/* Words to core 1, and its first one. */
#define DISARM  0u
#define ARM     1u
#define STARTED 2u

#define RECORD_WORDS (sizeof(latch_record_t) / sizeof(uint32_t))

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

/* ---- core 1 ---- */

static skip_input_t skip;
static uint32_t     words_to_send[RECORD_WORDS];
static uint32_t     unsent;

/* Interrupt. */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this board has one */
    skip_input_on_edge(&skip, captured_ticks);
}

static void obey_core0(void)
{
    uint32_t word;
    if (mailbox_take(&word)) {
        latch_disarm(&skip.latch);
        if (word == ARM) {
            latch_arm(&skip.latch, &LATCH);
        }
    }
}

/* A word at a time, and none while there is no room: core 1 waits for core 0 nowhere. */
static void send_record(void)
{
    latch_record_t record;
    if (unsent == 0u && latch_take(&skip.latch, &record)) {
        memcpy(words_to_send, &record, sizeof words_to_send);
        unsent = RECORD_WORDS;
    }
    if (unsent > 0u && mailbox_put(words_to_send[RECORD_WORDS - unsent])) {
        --unsent;
    }
}

static void run_core1(void)
{
    edge_start();
    mailbox_send(skip_input_start(&skip, &SKIP) == HAL_OK ? STARTED : DISARM);
    for (;;) {
        obey_core0();
        skip_input_poll(&skip, hal_clock_now_ticks());
        send_record();
    }
}

/* ---- core 0 ---- */

static plc_task_t     plc;
static latch_report_t report;

void wiring_scan(void)
{
    plc_task_scan(&plc);
}

static void obey(int command)
{
    uint32_t feed = (uint32_t)command - '0';
    if (feed < FEEDS) {
        axis_run(FEEDS_MM_PER_MIN[feed]);
    } else if (command == 's' || command == 'p' || command == 'n') {
        mailbox_send(command == 's' ? ARM : DISARM);
        latch_disarm(&plc.latch);
        if (command == 'p') {
            latch_arm(&plc.latch, &LATCH);
        }
    }
}

/* What follows a first word comes soon: core 1 waits for nothing but room. */
static bool take_skip_record(latch_record_t *record)
{
    uint32_t words[RECORD_WORDS];
    if (!mailbox_take(words)) {
        return false;
    }
    for (uint32_t at = 1u; at < RECORD_WORDS; ++at) {
        words[at] = mailbox_wait();
    }
    memcpy(record, words, sizeof words);
    return true;
}

static void send_latch(void)
{
    latch_record_t record;
    if (latch_report_poll(&report) &&
        (take_skip_record(&record) || latch_take(&plc.latch, &record))) {
        (void)latch_report_begin(&report, &record); /* nothing is pending, so it is taken */
        (void)latch_report_poll(&report);
    }
}

bool wiring_start(void)
{
    board_start();
    core1_start(run_core1);
    if (mailbox_wait() != STARTED || plc_task_start(&plc, &PLC) != HAL_OK) {
        return false;
    }
    scan_start(PLC.period_us); /* the task is whole before its first scan */
    disturbance_start();
    return true;
}

void wiring_round(void)
{
    obey(uart_take_byte());
    send_latch();
    disturbance_in_task();
}

#endif
