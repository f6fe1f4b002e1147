/*
 * The nominal chain, step by step as the campaign format states it, worked out once more here and
 * in plain figures, against what the simulation with the firmware in it makes of thousands of rigs.
 */
/* LINK: tests/support/play.c tests/support/dice.c $(OUT)/libskiplatch_sim.a */
#include <math.h>

#include "dice.h"
#include "play.h"
#include "unity.h"

#define RIGS        4000u
#define ROUNDING_NS 3.0 /* contact, delay and filter are each rounded to a nanosecond */
#define PI          3.14159265358979323846

typedef struct {
    sim_chain_t      chain;
    sim_controller_t controller;
    sim_touch_t      touch;
} rig_case_t;

/* What has to come out; times in ns. */
typedef struct {
    double speed_um_ns; /* at the surface */
    double contact;
    double edge;
    double pin;
    double latch; /* the earliest */
} forecast_t;

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- random rigs ---- */

static double maybe(dice_t *dice, double value)
{
    return dice_below(dice, 2u) == 0u ? 0.0 : value;
}

static sim_chain_t draw_chain(dice_t *dice)
{
    static const double ticks_us[] = {0.001, 0.0625, 0.25, 1.0, 4.0, 0.013889};
    static const double resolutions_um[] = {0.001, 0.01, 0.1, 1.0, 0.5};
    return (sim_chain_t){
        .pretravel_um = dice_between(dice, 0.0, 200.0),
        .lobe_um = maybe(dice, dice_between(dice, -250.0, 250.0)), /* the sum is cut at 0 */
        .lobe_phase_deg = dice_between(dice, -180.0, 180.0),
        .delay_us = maybe(dice, dice_any_scale(dice, 1.0, 20000.0)),
        .filter_us = maybe(dice, dice_any_scale(dice, 1.0, 1000.0)),
        .skip_latency_us = maybe(dice, dice_any_scale(dice, 0.1, 500.0)),
        .skip_jitter_us = maybe(dice, dice_any_scale(dice, 0.1, 100.0)),
        .tick_us = ticks_us[dice_below(dice, 6u)],
        .scan_us = rint(dice_any_scale(dice, 100.0, 20000.0)),
        .resolution_um = resolutions_um[dice_below(dice, 5u)],
        .accel_mm_s2 = dice_any_scale(dice, 100.0, 20000.0),
        .report_latency_us = maybe(dice, dice_any_scale(dice, 1.0, 10000.0)),
        .report_jitter_us = maybe(dice, dice_any_scale(dice, 1.0, 1000.0)),
        .is_machine = (int32_t)dice_below(dice, 2u),
    };
}

/* Moves of all lengths, a good part of them shorter than the ramp. */
static rig_case_t draw_case(dice_t *dice)
{
    rig_case_t rig = {.chain = draw_chain(dice)};
    rig.touch = play_touch(1u, (int32_t)dice_below(dice, 2u), dice_between(dice, 0.0, 5000.0));
    rig.touch.feed_mm_min = dice_any_scale(dice, 10.0, 10000.0);
    rig.touch.approach_mm = dice_any_scale(dice, 0.01, 30.0);
    rig.touch.alpha_deg = dice_between(dice, -360.0, 360.0);
    rig.touch.beta_deg = dice_between(dice, -90.0, 90.0);
    rig.controller = (sim_controller_t){
        .overtravel_mm = 200.0, /* so far that the axis is never on its way to a standstill */
        .reaction_us = 1000.0,
        .settle_us = 500000.0, /* a long delay delays the release as well */
        .image_delay_scans = (int32_t)maybe(dice, dice_below(dice, 8u)),
    };
    return rig;
}

/* ---- the chain ---- */

static double pretravel_um(const sim_chain_t *chain, const sim_touch_t *touch)
{
    double azimuth = (touch->alpha_deg - chain->lobe_phase_deg) * PI / 180.0;
    double w = chain->pretravel_um +
               chain->lobe_um * cos(touch->beta_deg * PI / 180.0) * cos(3.0 * azimuth);
    return w > 0.0 ? w : 0.0;
}

/* Steps 1 to 3: contact, edge, pin. */
static forecast_t forecast_pin(const rig_case_t *rig)
{
    const sim_chain_t *chain = &rig->chain;
    double             v = rig->touch.feed_mm_min / 60.0;
    double             a = chain->accel_mm_s2;
    double             way_mm = rig->touch.approach_mm;
    double             contact_s = v / a + (way_mm - v * v / (2.0 * a)) / v;
    if (way_mm < v * v / (2.0 * a)) {
        v = sqrt(2.0 * a * way_mm);
        contact_s = sqrt(2.0 * way_mm / a);
    }
    forecast_t forecast = {.speed_um_ns = v * 1e-6};
    forecast.contact = (rig->touch.time_s + contact_s) * 1e9;
    forecast.edge = forecast.contact;
    if (chain->is_machine) {
        forecast.edge +=
            pretravel_um(chain, &rig->touch) / forecast.speed_um_ns + chain->delay_us * 1e3;
    }
    forecast.pin = forecast.edge + chain->filter_us * 1e3;
    return forecast;
}

/* The phase of the scans, seen through a clock that shows it to the nanosecond. */
static double scan_phase_ns(const rig_case_t *rig)
{
    rig_case_t    probing = *rig;
    sim_outcome_t outcome;
    probing.chain.tick_us = 0.001;
    probing.touch = play_touch(2u, SIM_PATH_PLC, 1.0);
    play(&probing.chain, &probing.controller, &probing.touch, 1u, &outcome);
    return fmod(outcome.latch_us * 1e3, rig->chain.scan_us * 1e3);
}

/* Step 4. A pin within the rounding of a scan may fall on either side of it. */
static void forecast_latch(const rig_case_t *rig, double seen_ns, forecast_t *forecast)
{
    if (rig->touch.path == SIM_PATH_SKIP) {
        forecast->latch = forecast->pin + rig->chain.skip_latency_us * 1e3;
        return;
    }
    double scan_ns = rig->chain.scan_us * 1e3;
    double phase_ns = scan_phase_ns(rig);
    double first = phase_ns + ceil((forecast->pin - phase_ns) / scan_ns) * scan_ns;
    double to_next = first - forecast->pin;
    first -= scan_ns - to_next < ROUNDING_NS && seen_ns < first - scan_ns / 2.0 ? scan_ns : 0.0;
    forecast->latch = first + rig->controller.image_delay_scans * scan_ns;
}

/* ---- the comparison ---- */

static void check_within(double low, double high, double value, const char *what)
{
    double middle = (low + high) / 2.0;
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(high - middle, middle, value, what);
}

/* Step 5: ticks are cut off; the position is that of the latch, rounded. */
static void check_latch(const rig_case_t *rig, const forecast_t *forecast, const sim_outcome_t *o)
{
    double jitter_ns = rig->touch.path == SIM_PATH_SKIP ? rig->chain.skip_jitter_us * 1e3 : 0.0;
    double tick_ns = rig->chain.tick_us * 1e3;
    double low_um = (forecast->latch - forecast->contact) * forecast->speed_um_ns;
    double high_um = low_um + jitter_ns * forecast->speed_um_ns;
    double slack_um = rig->chain.resolution_um / 2.0 + ROUNDING_NS * forecast->speed_um_ns + 1e-9;
    double counts = o->deviation_um / rig->chain.resolution_um;

    check_within(forecast->latch - tick_ns - ROUNDING_NS, forecast->latch + jitter_ns + ROUNDING_NS,
                 o->latch_us * 1e3, "latch");
    check_within(low_um - slack_um, high_um + slack_um, o->deviation_um, "deviation");
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, rint(counts), counts, "resolution");
}

static void check_ticks(const rig_case_t *rig, const sim_outcome_t *outcome)
{
    double ticks = outcome->latch_us / rig->chain.tick_us;
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-3, rint(ticks), ticks, "ticks");
}

/* The speed is constant from the contact on, so time and position tell the same latch. */
static void check_time_and_position_agree(const rig_case_t *rig, const forecast_t *forecast,
                                          const sim_outcome_t *o)
{
    double moved_um = (o->latch_us * 1e3 - forecast->contact) * forecast->speed_um_ns;
    double tick_um = rig->chain.tick_us * 1e3 * forecast->speed_um_ns;
    double slack_um = rig->chain.resolution_um / 2.0 + ROUNDING_NS * forecast->speed_um_ns + 1e-9;
    check_within(moved_um - slack_um, moved_um + tick_um + slack_um, o->deviation_um, "both");
}

/* Step 6. */
static void check_report(const rig_case_t *rig, const sim_outcome_t *o)
{
    double tick_us = rig->chain.tick_us;
    double after_us = o->report_us - o->latch_us;
    double slack_us = ROUNDING_NS * 1e-3;
    check_within(rig->chain.report_latency_us - slack_us,
                 rig->chain.report_latency_us + rig->chain.report_jitter_us + tick_us + slack_us,
                 after_us, "report");
}

static void check_case(const rig_case_t *rig)
{
    sim_outcome_t outcome;
    forecast_t    forecast = forecast_pin(rig);
    play(&rig->chain, &rig->controller, &rig->touch, 1u, &outcome);
    play_check_ok(&outcome, 1u);
    forecast_latch(rig, outcome.latch_us * 1e3, &forecast);

    TEST_ASSERT_DOUBLE_WITHIN(ROUNDING_NS, forecast.edge, outcome.true_edge_us * 1e3);
    if (rig->chain.is_machine) {
        TEST_ASSERT_TRUE_MESSAGE(isnan(outcome.edge_us), "nobody knows the edge on a machine");
    } else {
        TEST_ASSERT_EQUAL_DOUBLE(outcome.true_edge_us, outcome.edge_us);
    }
    check_latch(rig, &forecast, &outcome);
    check_ticks(rig, &outcome);
    check_time_and_position_agree(rig, &forecast, &outcome);
    check_report(rig, &outcome);
}

void test_thousands_of_rigs_play_the_nominal_chain(void)
{
    dice_t   dice = dice_seed(1u);
    unsigned short_moves = 0u;
    for (unsigned i = 0u; i < RIGS; ++i) {
        rig_case_t rig = draw_case(&dice);
        double     v = rig.touch.feed_mm_min / 60.0;
        check_case(&rig);
        short_moves += rig.touch.approach_mm < v * v / (2.0 * rig.chain.accel_mm_s2) ? 1u : 0u;
    }
    TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(RIGS / 10u, short_moves, "hardly any short move");
}

/* ---- single figures from the documents ---- */

static double deviation_um(const sim_chain_t *chain, sim_touch_t touch)
{
    sim_outcome_t    outcome;
    sim_controller_t controller = PLAY_ONE_TOUCH;
    controller.overtravel_mm = 50.0;
    play(chain, &controller, &touch, 1u, &outcome);
    play_check_ok(&outcome, 1u);
    return outcome.deviation_um;
}

/* 4 µs at 3000 mm/min are 0.2 µm, 0.2 ms are 10 µm (reference document, section 1). */
void test_a_reaction_time_costs_feed_times_itself(void)
{
    sim_chain_t chain = PLAY_BENCH;
    sim_touch_t touch = play_touch(0u, SIM_PATH_SKIP, 1.0);
    touch.feed_mm_min = 3000.0;
    chain.skip_latency_us = 4.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.2, deviation_um(&chain, touch));
    chain.skip_latency_us = 200.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 10.0, deviation_um(&chain, touch));
    touch.feed_mm_min = 30.0;
    chain.skip_latency_us = 4000.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 2.0, deviation_um(&chain, touch));
}

/* A 4 ms scan at 3000 mm/min: 0.2 mm of range, and v·T/2 of it on average. */
void test_a_scan_costs_feed_times_period(void)
{
    const unsigned n = 1000u;
    double         least_um = INFINITY;
    double         most_um = 0.0;
    double         sum_um = 0.0;
    for (unsigned i = 0u; i < n; ++i) {
        sim_touch_t touch = play_touch(i, SIM_PATH_PLC, 1.0 + 4e-6 * i);
        touch.feed_mm_min = 3000.0;
        double um = deviation_um(&PLAY_BENCH, touch);
        least_um = fmin(least_um, um);
        most_um = fmax(most_um, um);
        sum_um += um;
    }

    TEST_ASSERT_DOUBLE_WITHIN(0.2 + 0.002, 200.0 - 0.2, most_um - least_um);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 100.0, sum_um / n);
}

/* A probe touches later by its pretravel at any feed, and by the feed times its delay. */
void test_pretravel_is_a_way_and_delay_a_time(void)
{
    sim_chain_t chain = PLAY_MACHINE;
    chain.filter_us = 0.0;
    chain.skip_latency_us = 0.0;
    for (double feed = 10.0; feed < 3000.0; feed *= 2.0) {
        sim_touch_t touch = play_touch(0u, SIM_PATH_SKIP, 1.0);
        touch.feed_mm_min = feed;
        double expected_um = chain.pretravel_um + feed / 60e3 * chain.delay_us;

        TEST_ASSERT_DOUBLE_WITHIN(0.001, expected_um, deviation_um(&chain, touch));
    }
}

void test_the_lobes_are_three_and_vanish_along_the_probe_axis(void)
{
    sim_chain_t chain = PLAY_MACHINE;
    sim_touch_t touch = play_touch(0u, SIM_PATH_SKIP, 1.0);
    double      base_um = deviation_um(&chain, touch);
    chain.lobe_um = 20.0;
    chain.lobe_phase_deg = 17.0;
    for (double alpha = 0.0; alpha < 360.0; alpha += 15.0) {
        touch.alpha_deg = alpha;
        touch.beta_deg = 0.0;
        double lobe_um = 20.0 * cos(3.0 * (alpha - 17.0) * PI / 180.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, base_um + lobe_um, deviation_um(&chain, touch));
        touch.beta_deg = 90.0;
        TEST_ASSERT_DOUBLE_WITHIN(0.002, base_um, deviation_um(&chain, touch));
    }
}
