/*
 * skiplatch-controller: the firmware on the Linux port. Watches one GPIO line on the skip or on the
 * PLC path and sends each latch as a record over CAN.
 */
#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "axis.h"
#include "bus.h"
#include "clock.h"
#include "edge.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "loop.h"
#include "options.h"
#include "realtime.h"
#include "report/latch_report.h"
#include "say.h"
#include "scan.h"
#include "signals.h"

#define EXIT_USAGE    2
#define CHANNEL       0u
#define AXIS          0u
#define NM_PER_MM     1.0e6
#define NM_PER_UM     1.0e3
#define S_PER_MIN     60.0
#define FAREWELL_MS   10
#define FAREWELLS_MAX 100u

/* Every edge is a touch: what a bench injects does not bounce unless it is told to. */
static const latch_config_t LATCH = {.repeated = true, .confirm_ticks = 0u, .holdoff_ticks = 0u};

static options_t      options;
static skip_input_t   skip;
static plc_task_t     plc;
static latch_report_t report;
static uint64_t       latches;       /* handed to the bus */
static uint64_t       overruns;      /* latches lost because the bus did not take the ones before */
static uint16_t       overruns_seen; /* of the latch's own counter, which wraps */
static bool           is_ending;
static int            signals = -1;

static latch_t *measuring_latch(void)
{
    return options.is_plc ? &plc.latch : &skip.latch;
}

/* ---- what the port calls ---- */

void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this port has one */
    skip_input_on_edge(&skip, captured_ticks);
}

static void on_scan(void)
{
    plc_task_scan(&plc);
}

static void count_overruns(void)
{
    uint16_t now = latch_counters(measuring_latch()).overruns;
    overruns += (uint16_t)(now - overruns_seen);
    overruns_seen = now;
}

static bool is_enough(void)
{
    return options.touches != 0u && latches == options.touches;
}

static void send_latch(void)
{
    latch_record_t record;
    if (latch_report_poll(&report) && !is_enough() && latch_take(measuring_latch(), &record)) {
        (void)latch_report_begin(&report, &record); /* nothing is pending, so it is taken */
        (void)latch_report_poll(&report);
        ++latches;
        if (is_enough()) {
            latch_disarm(measuring_latch());
            is_ending = true;
        }
    }
}

/* The level is no news to a latch that believes every edge at once; the time is. */
static void run_task(void)
{
    if (!options.is_plc) {
        latch_poll(&skip.latch, hal_clock_now_ticks(), latch_level(&skip.latch));
    }
    count_overruns();
    send_latch();
}

/* ---- counters ---- */

static void print_number(const char *name, uint64_t value, const char *end)
{
    printf("\"%s\": %" PRIu64 "%s", name, value, end);
}

static void print_bus(const bus_counters_t *bus)
{
    print_number("frames_sent", bus->frames_sent, ", ");
    print_number("frames_confirmed", bus->frames_confirmed, ", ");
    print_number("frames_waiting", bus->frames_waiting, ", ");
    print_number("frames_foreign", bus->frames_foreign, ", ");
    print_number("frames_missed", bus->frames_missed, ", ");
    print_number("queue_full", bus->queue_full, ", ");
    print_number("send_full", bus->send_full, ", ");
    print_number("bus_downs", bus->downs, ", ");
    print_number("bus_offs", bus->bus_offs, ", ");
    print_number("error_passives", bus->error_passives, ", ");
    print_number("error_frames", bus->error_frames, ", ");
    print_number("slowest_frame_us", bus->slowest_us, "}\n");
}

/* "dropped" is the sum of all ways in which an edge was seen by the kernel and never reported. */
static void print_counters(void)
{
    scan_counters_t scan = scan_counters();
    edge_counters_t edge = edge_counters();
    bus_counters_t  bus = bus_counters();
    putchar('{');
    print_number("scans", scan.scans, ", ");
    print_number("overruns", scan.overruns, ", ");
    print_number("edges", edge.edges, ", ");
    print_number("latches", latches, ", ");
    print_number("dropped", edge.edges_lost + overruns, ", ");
    print_number("edges_lost", edge.edges_lost, ", ");
    print_number("latches_lost", overruns, ", ");
    print_number("line_losses", edge.losses, ", ");
    print_bus(&bus);
    (void)fflush(stdout);
}

static void on_signal(void)
{
    signals_t taken = signals_take(signals);
    is_ending = is_ending || taken.end;
    if (taken.tell) {
        print_counters();
    }
}

/* ---- start, run, end ---- */

static bool set_up_process(void)
{
    return (options.cpu < 0 || realtime_pin(options.cpu) == 0) &&
           (!options.lock_memory || realtime_lock_memory() == 0) &&
           (options.fifo_priority == 0 || realtime_fifo(options.fifo_priority) == 0);
}

static int start_input(void)
{
    const skip_input_config_t skip_config = {
        .edge = {.channel = CHANNEL,
                 .active_low = options.line.active_low,
                 .glitch_filter_us = (uint16_t)options.line.debounce_us},
        .axis = AXIS,
    };
    const plc_task_config_t plc_config = {
        .channel = CHANNEL,
        .axis = AXIS,
        .period_us = (uint16_t)options.scan_us,
    };
    return options.is_plc ? plc_task_start(&plc, &plc_config)
                          : skip_input_start(&skip, &skip_config);
}

/* The latch waits before the first edge or scan can come. */
static bool arm(void)
{
    int result = start_input();
    if (result != HAL_OK) {
        say("line %u of \"%s\" does not give edge events as asked for; without --debounce-us?",
            options.line.offset, options.line.chip);
        return false;
    }
    latch_arm(measuring_latch(), &LATCH);
    if (options.is_plc && scan_start(options.scan_us) != 0) {
        say("no timer for scans every %u us", options.scan_us);
        return false;
    }
    return true;
}

static bool start(void)
{
    double count_nm = options.resolution_um * NM_PER_UM;
    axis_run(options.feed_mm_min * NM_PER_MM / S_PER_MIN / count_nm);
    signals = signals_start();
    return set_up_process() && bus_open(options.can, options.latch_id) == 0 &&
           edge_open(&options.line) == 0 && arm();
}

static bool is_all_out(void)
{
    bus_counters_t bus = bus_counters();
    return report.pending == 0u && bus.frames_waiting == 0u &&
           bus.frames_confirmed + bus.frames_missed >= bus.frames_sent;
}

/* What is latched still goes out, if the bus takes it within a second. */
static void end(const loop_calls_t *calls)
{
    edge_close();
    scan_stop();
    run_task();
    for (unsigned i = 0u; i < FAREWELLS_MAX && !is_all_out(); ++i) {
        loop_run_once(calls, FAREWELL_MS);
    }
    print_counters();
    bus_close();
}

int main(int argc, char **argv)
{
    say_as("skiplatch-controller");
    switch (options_parse(argc, argv, &options)) {
    case OPTIONS_RUN:
        break;
    case OPTIONS_HELP:
        return EXIT_SUCCESS;
    case OPTIONS_BAD:
    default:
        return EXIT_USAGE;
    }
    if (!start()) {
        return EXIT_USAGE;
    }
    puts("ready");
    (void)fflush(stdout);
    loop_calls_t calls = {
        .task = run_task, .on_scan = on_scan, .on_signal = on_signal, .signals = signals};
    while (!is_ending) {
        loop_run_once(&calls, -1);
    }
    end(&calls);
    return EXIT_SUCCESS;
}
