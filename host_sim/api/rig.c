#include "api/rig.h"

#include <math.h>

#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/ticks.h"
#include "port.h"

#define NO_PATH   (-1)
#define CHANNEL   0u
#define AXIS      0u
#define UM_PER_MM 1000.0

static _Thread_local rig_t *bound;

void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* the rig has one */
    skip_input_on_edge(&bound->skip, captured_ticks);
}

static void bind(rig_t *rig)
{
    bound = rig;
    sim_port_bind(&rig->sim);
}

void rig_boot(rig_t *rig, const sim_chain_t *chain, const sim_controller_t *controller,
              const sim_setting_t *settings, uint32_t count, uint64_t seed, uint64_t replicate,
              sim_ns_t now)
{
    *rig = (rig_t){.controller = controller, .path = NO_PATH};
    sim_boot(&rig->sim, chain, settings, count, seed, replicate, now);
    sim_set_begins(&rig->sim, controller);
    bind(rig);
}

static void stop_path(rig_t *rig)
{
    if (rig->path == SIM_PATH_SKIP) {
        skip_input_stop(&rig->skip);
    }
    rig->path = NO_PATH;
}

/* Age of the input image at this touch. */
static uint8_t image_delay_scans(rig_t *rig)
{
    double scans = sim_change(&rig->sim, SIM_IMAGE_DELAY, rig->controller->image_delay_scans);
    return (uint8_t)fmin(scans, UINT8_MAX);
}

/* Set up the input of `path` unless it runs already, and with the image as old as now. */
static int start_path(rig_t *rig, int path)
{
    int     result;
    uint8_t delay_scans = path == SIM_PATH_SKIP ? 0u : image_delay_scans(rig);
    if (rig->path == path && (path == SIM_PATH_SKIP || rig->plc.image_delay_scans == delay_scans)) {
        return HAL_OK;
    }
    stop_path(rig);
    sim_scan_restart(&rig->sim.scan, rig->sim.now);
    rig->cycle = (touch_cycle_t){.state = TOUCH_IDLE};
    if (path == SIM_PATH_SKIP) {
        skip_input_config_t config = {.edge = {.channel = CHANNEL}, .axis = AXIS};
        result = skip_input_start(&rig->skip, &config);
    } else {
        plc_task_config_t config = {
            .channel = CHANNEL,
            .axis = AXIS,
            .image_delay_scans = delay_scans,
            .period_us = (uint16_t)fmin(rig->sim.chain->scan_us + 0.5, UINT16_MAX),
        };
        result = plc_task_start(&rig->plc, &config);
    }
    rig->path = result == HAL_OK ? path : NO_PATH;
    return result;
}

static latch_t *latch_of(rig_t *rig)
{
    return rig->path == SIM_PATH_SKIP ? &rig->skip.latch : &rig->plc.latch;
}

static int32_t counts(const rig_t *rig, double mm)
{
    return sim_counts(&rig->sim, mm * UM_PER_MM);
}

static touch_config_t cycle_config(const rig_t *rig, const sim_touch_t *touch)
{
    const sim_controller_t *controller = rig->controller;
    return (touch_config_t){
        .two_touches = controller->two_touches != 0,
        .approach_counts = counts(rig, touch->approach_mm),
        .overtravel_counts = counts(rig, controller->overtravel_mm),
        .back_off_counts = counts(rig, controller->back_off_mm),
        .feed_mm_min = controller->two_touches ? controller->fast_feed_mm_min : touch->feed_mm_min,
        .measure_feed_mm_min = touch->feed_mm_min,
        .timeout_us = 0u, /* virtual time cannot hang */
        .settle_us = (uint32_t)controller->settle_us,
        .confirm_us = (uint32_t)controller->confirm_us,
        .holdoff_us = (uint32_t)controller->holdoff_us,
    };
}

static touch_input_t cycle_input(const rig_t *rig, uint32_t now_ticks)
{
    return (touch_input_t){
        .now_ticks = now_ticks,
        .position_counts = hal_axis_position_counts(AXIS),
        .is_moving = sim_is_moving(&rig->sim),
    };
}

/* The motion controller: carry out what the cycle asks for. */
static void carry_out(rig_t *rig)
{
    touch_request_t request;
    if (!touch_cycle_take_request(&rig->cycle, &request)) {
        return;
    }
    if (request.kind == TOUCH_STOP) {
        sim_stop(&rig->sim, sim_ns_from_us(rig->controller->reaction_us));
    } else {
        sim_move(&rig->sim, request.target_counts * rig->sim.count_um, request.feed_mm_min);
    }
}

static void send_latch(rig_t *rig)
{
    latch_record_t record;
    if (touch_cycle_take_latch(&rig->cycle, &record)) {
        (void)latch_report_begin(&rig->report, &record);
    }
    (void)latch_report_poll(&rig->report);
}

/* Input, cycle, motion, report: what both kinds of task do after reading the input. */
static void run_cycle(rig_t *rig, uint32_t now_ticks)
{
    touch_state_t before = rig->cycle.state;
    touch_input_t input = cycle_input(rig, now_ticks);
    touch_state_t after = touch_cycle_poll(&rig->cycle, &input);

    if (after == TOUCH_DONE && before != TOUCH_DONE) {
        rig->done_at = rig->sim.now;
    }
    carry_out(rig);
    send_latch(rig);
}

/*
 * The task of the skip input; it sleeps until something happens, or until time alone makes it
 * act.
 */
static void run_task(rig_t *rig)
{
    uint32_t now_ticks = hal_clock_now_ticks();

    skip_input_poll(&rig->skip, now_ticks);
    run_cycle(rig, now_ticks);
    sim_wake_after(&rig->sim, touch_cycle_idle_ticks(&rig->cycle, now_ticks));
}

/* A PLC has no other clock than its scan: it acts at the first scan after something happened. */
static void plan_scan(rig_t *rig, uint32_t now_ticks)
{
    sim_ns_t wanted = rig->sim.now;
    if (plc_task_is_settled(&rig->plc) && !rig->controller->every_scan) {
        wanted = sim_time_after(&rig->sim, touch_cycle_idle_ticks(&rig->cycle, now_ticks));
    }
    sim_scan_await(&rig->sim.scan, wanted);
}

static void run_scan(rig_t *rig)
{
    uint32_t now_ticks = hal_clock_now_ticks();
    int64_t  left_out = sim_scan_execute(&rig->sim.scan);
    if (left_out > 0) {
        sim_ns_t last = rig->sim.now - (sim_ns_t)rig->sim.scan.period_ns;
        plc_task_skip_idle(&rig->plc, (uint32_t)left_out,
                           (uint32_t)sim_clock_ticks(&rig->sim, last));
    }
    plc_task_scan(&rig->plc);
    run_cycle(rig, now_ticks);
    plan_scan(rig, now_ticks);
}

/* A stamp without the wrap. It is of before the report arrives, but for a clock that stamps late:
 * then it may be of a little after. */
static int64_t unwrapped(uint64_t now_ticks, uint32_t stamp)
{
    uint32_t elapsed = ticks_elapsed((uint32_t)now_ticks, stamp);
    if (elapsed >= TICKS_BEFORE) {
        return (int64_t)now_ticks + ticks_elapsed(stamp, (uint32_t)now_ticks);
    }
    return (int64_t)now_ticks - elapsed;
}

/* The recorder: put frames together and take the time of arrival. */
static void record(rig_t *rig, sim_outcome_t *outcome)
{
    sim_t         *sim = &rig->sim;
    latch_record_t record;
    while (sim_bus_arrival(&sim->bus) == sim->now) {
        const uint8_t *frame = sim_bus_take(&sim->bus);
        if (latch_frame_decode(&rig->decoder, frame, &record) != LATCH_FRAME_RECORD) {
            continue;
        }
        int64_t latch_ticks = unwrapped(sim_clock_ticks(sim, sim->now), record.ticks);
        outcome->latch_us = (double)latch_ticks * sim->tick_ps / (SIM_PS_PER_NS * SIM_NS_PER_US);
        outcome->report_us = sim_us_from_ns(sim->now);
        double line_um = sim->touch->datum_um - sim->off_line_um;
        outcome->deviation_um = record.position_counts * sim->count_um + line_um;
        outcome->status = SIM_STATUS_OK;
    }
}

static void handle(rig_t *rig, sim_event_t event, sim_outcome_t *outcome)
{
    if (event == SIM_EVENT_FRAME) {
        record(rig, outcome);
    } else if (event == SIM_EVENT_SCAN) {
        run_scan(rig);
    } else if (rig->path == SIM_PATH_PLC) {
        sim_scan_await(&rig->sim.scan, rig->sim.now);
    } else if (event != SIM_EVENT_LEVEL || !rig->sim.line.pin) { /* else the interrupt follows */
        run_task(rig);
    }
}

static bool is_running(const rig_t *rig)
{
    touch_state_t state = rig->cycle.state;
    return (state != TOUCH_DONE && state != TOUCH_FAILED) ||
           sim_bus_arrival(&rig->sim.bus) != SIM_NEVER;
}

/* The touch itself: when the contact closed, and whether the latch belongs to it. */
static void finish(rig_t *rig, sim_outcome_t *outcome)
{
    const touch_result_t *result = touch_cycle_result(&rig->cycle);
    sim_t                *sim = &rig->sim;
    outcome->error = (int32_t)result->error;
    outcome->start_delay_us = sim_us_from_ns(sim->start_delay);
    if (sim->closed_at != SIM_NEVER) {
        outcome->true_edge_us = sim_us_from_ns(sim->closed_at);
        if (!sim->chain->is_machine) {
            outcome->edge_us = outcome->true_edge_us +
                               sim_random_normal(&sim->random, sim->chain->reference_jitter_us);
        }
    }
    if (result->error == TOUCH_OK) {
        outcome->overtravel_um = result->overtravel_counts * sim->count_um;
        outcome->cycle_s = (double)(rig->done_at - sim_touch_start(sim, sim->touch)) / SIM_NS_PER_S;
    } else {
        stop_path(rig); /* as an operator would, set up anew after a failure */
    }
}

static void start_cycle(rig_t *rig, const sim_touch_t *touch)
{
    uint32_t       now_ticks = hal_clock_now_ticks();
    touch_config_t config = cycle_config(rig, touch);
    touch_input_t  input = cycle_input(rig, now_ticks);

    (void)touch_cycle_start(&rig->cycle, latch_of(rig), &config, &input);
    carry_out(rig);
    if (rig->path == SIM_PATH_PLC) {
        plan_scan(rig, now_ticks);
    }
}

int rig_play(rig_t *rig, const sim_touch_t *touch, sim_outcome_t *outcome)
{
    *outcome = (sim_outcome_t){NAN, NAN, NAN, NAN, NAN, NAN, NAN, 0.0, SIM_STATUS_MISSED, TOUCH_OK};
    bind(rig);
    if (sim_touch_start(&rig->sim, touch) < rig->sim.now) {
        stop_path(rig); /* the last cycle ended later than this one begins: as if it had not been */
    }
    sim_begin_touch(&rig->sim, touch);
    if (!sim_clock_goes_on(&rig->sim)) {
        return RIG_ERR_CLOCK;
    }
    int result = start_path(rig, touch->path);
    if (result != HAL_OK) {
        return result;
    }

    start_cycle(rig, touch);
    while (is_running(rig)) {
        handle(rig, sim_advance(&rig->sim), outcome);
    }
    finish(rig, outcome);
    return HAL_OK;
}
