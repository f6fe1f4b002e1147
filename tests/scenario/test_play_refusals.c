/* What the library of the simulation refuses to play, and that it says why. */
/* LINK: tests/support/play.c $(OUT)/libskiplatch_sim.a */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "cycle/touch_cycle.h"
#include "play.h"
#include "unity.h"

#define SMALL 1e-9 /* by how much a value may miss its range, as a share of it */

/* A field and its range. */
typedef struct {
    size_t offset;
    double low;
    double high;
} range_t;

#define LENGTH   0.0, 1e4
#define DURATION 0.0, 1e9

static const range_t CHAIN_RANGES[] = {
    {offsetof(sim_chain_t, pretravel_um), LENGTH},
    {offsetof(sim_chain_t, lobe_um), -1e4, 1e4},
    {offsetof(sim_chain_t, repeatability_um), LENGTH},
    {offsetof(sim_chain_t, delay_us), DURATION},
    {offsetof(sim_chain_t, filter_us), DURATION},
    {offsetof(sim_chain_t, skip_latency_us), DURATION},
    {offsetof(sim_chain_t, skip_jitter_us), DURATION},
    {offsetof(sim_chain_t, tick_us), 1e-3, 1e3},
    {offsetof(sim_chain_t, scan_us), 100.0, 20000.0},
    {offsetof(sim_chain_t, resolution_um), 1e-4, 1e4},
    {offsetof(sim_chain_t, accel_mm_s2), 1e-3, 1e6},
    {offsetof(sim_chain_t, report_latency_us), DURATION},
    {offsetof(sim_chain_t, report_jitter_us), DURATION},
    {offsetof(sim_chain_t, reference_jitter_us), DURATION},
    {offsetof(sim_chain_t, seat.seat_mm), 0.0, 1e6},
    {offsetof(sim_chain_t, seat.stylus_mm), 0.0, 1e6},
    {offsetof(sim_chain_t, seat.stem_n_m2), 0.0, 1e6},
    {offsetof(sim_chain_t, seat.axial_um_n), 0.0, 1e6},
    {offsetof(sim_chain_t, seat.evenness), 0.0, 1.0},
    {offsetof(sim_chain_t, seat.reseat_um), LENGTH},
};

static const range_t CONTROLLER_RANGES[] = {
    {offsetof(sim_controller_t, overtravel_mm), LENGTH},
    {offsetof(sim_controller_t, back_off_mm), LENGTH},
    {offsetof(sim_controller_t, fast_feed_mm_min), 0.0, 1e6},
    {offsetof(sim_controller_t, reaction_us), DURATION},
    {offsetof(sim_controller_t, confirm_us), DURATION},
    {offsetof(sim_controller_t, holdoff_us), DURATION},
    {offsetof(sim_controller_t, settle_us), DURATION},
    {offsetof(sim_controller_t, scan_phase_us), DURATION},
    {offsetof(sim_controller_t, scan_spread_us), DURATION},
    {offsetof(sim_controller_t, start_spread_us), DURATION},
};

static const range_t TOUCH_RANGES[] = {
    {offsetof(sim_touch_t, time_s), 0.0, 8640000.0},
    {offsetof(sim_touch_t, feed_mm_min), 1e-3, 1e6},
    {offsetof(sim_touch_t, approach_mm), 1e-6, 1e4},
    {offsetof(sim_touch_t, pulse_us), DURATION},
};

#define COUNT(table) (sizeof(table) / sizeof *(table))

static sim_chain_t      chain;
static sim_controller_t controller;
static sim_touch_t      touch;
static sim_outcome_t    outcome;
static const sim_rig_t  rig = {.chain = &chain, .controller = &controller, .seed = 1u};

void setUp(void)
{
    chain = PLAY_BENCH;
    controller = PLAY_ONE_TOUCH;
    controller.two_touches = 1;
    touch = play_touch(0u, SIM_PATH_SKIP, 1.0);
}

void tearDown(void)
{
}

static int attempt(uint64_t n)
{
    return sim_play(&rig, &touch, n, 1u, 1u, &outcome);
}

static void set(void *object, const range_t *range, double value)
{
    memcpy((char *)object + range->offset, &value, sizeof value);
}

/* Without touches nothing is played, however odd the rig; all the same it is looked at. */
static void check_range(void *object, const range_t *range, uint64_t n, int refusal)
{
    double width = range->high - range->low;
    double bad[] = {range->low - SMALL * width, range->high + SMALL * width, (double)NAN,
                    (double)INFINITY, -(double)INFINITY};
    for (size_t i = 0u; i < COUNT(bad); ++i) {
        setUp();
        set(object, range, bad[i]);
        TEST_ASSERT_EQUAL_INT(refusal, attempt(n));
    }
    setUp();
}

static void check_accepted(void *object, const range_t *range)
{
    setUp();
    set(object, range, range->low);
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, attempt(0u));
    set(object, range, range->high);
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, attempt(0u));
    setUp();
}

void test_a_chain_within_its_ranges_is_played(void)
{
    for (size_t i = 0u; i < COUNT(CHAIN_RANGES); ++i) {
        check_accepted(&chain, &CHAIN_RANGES[i]);
    }
}

void test_a_chain_out_of_range_is_refused(void)
{
    for (size_t i = 0u; i < COUNT(CHAIN_RANGES); ++i) {
        check_range(&chain, &CHAIN_RANGES[i], 0u, SIM_PLAY_ERR_CHAIN);
    }
    chain.lobe_phase_deg = (double)NAN;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_CHAIN, attempt(0u));
}

void test_a_controller_within_its_ranges_is_played(void)
{
    for (size_t i = 0u; i < COUNT(CONTROLLER_RANGES); ++i) {
        check_accepted(&controller, &CONTROLLER_RANGES[i]);
    }
}

void test_a_controller_out_of_range_is_refused(void)
{
    for (size_t i = 0u; i < COUNT(CONTROLLER_RANGES); ++i) {
        check_range(&controller, &CONTROLLER_RANGES[i], 0u, SIM_PLAY_ERR_CONTROL);
    }
}

void test_images_up_to_seven_scans_old_are_played(void)
{
    static const struct {
        int32_t scans;
        int     result;
    } cases[] = {
        {0, SIM_PLAY_OK}, {7, SIM_PLAY_OK}, {8, SIM_PLAY_ERR_CONTROL}, {-1, SIM_PLAY_ERR_CONTROL}};
    for (size_t i = 0u; i < COUNT(cases); ++i) {
        controller.image_delay_scans = cases[i].scans;
        TEST_ASSERT_EQUAL_INT(cases[i].result, attempt(0u));
    }
}

void test_what_belongs_to_two_touches_does_not_matter_for_one(void)
{
    controller.two_touches = 0;
    controller.back_off_mm = -1.0;
    controller.fast_feed_mm_min = (double)NAN;

    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, attempt(0u));
}

void test_a_touch_out_of_range_is_refused(void)
{
    for (size_t i = 0u; i < COUNT(TOUCH_RANGES); ++i) {
        check_range(&touch, &TOUCH_RANGES[i], 1u, SIM_PLAY_ERR_TOUCH);
    }
}

void test_a_touch_in_no_direction_or_on_no_path_is_refused(void)
{
    touch.alpha_deg = (double)NAN;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, attempt(1u));
    setUp();
    touch.datum_um = (double)NAN;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, attempt(1u));
    setUp();
    touch.surface_um = (double)NAN;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, attempt(1u));
    setUp();
    touch.beta_deg = (double)INFINITY;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, attempt(1u));
    setUp();
    touch.further_temp_c[SIM_FURTHER_THERMOMETERS - 1] = (double)NAN;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, attempt(1u));
    setUp();
    touch.path = 2;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, attempt(1u));
    setUp();
    touch.path = -1;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, attempt(1u));
}

void test_one_bad_touch_among_good_ones_is_found(void)
{
    sim_touch_t   touches[] = {touch, touch, touch};
    sim_outcome_t outcomes[3];
    touches[2].feed_mm_min = 0.0;

    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_TOUCH, sim_play(&rig, touches, 3u, 1u, 1u, outcomes));
}

/* A clock that goes by 1000 ppm faster for each kelvin above 20 °C. */
static int attempt_warm(double temp_c)
{
    sim_setting_t warmth = {.parameters = {0.0, 0.0, 1000.0}};
    sim_rig_t     drifting = rig;
    while (strcmp(sim_effect_describe((uint32_t)warmth.effect)->id, "timer_drift") != 0) {
        ++warmth.effect;
    }
    drifting.settings = &warmth;
    drifting.settings_count = 1u;
    touch.temp_c = temp_c;
    return sim_play(&drifting, &touch, 1u, 1u, 1u, &outcome);
}

void test_a_clock_below_half_or_above_twice_its_rate_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, attempt_warm(20.0 - 499.99));
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_CLOCK, attempt_warm(20.0 - 500.01));
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, attempt_warm(20.0 + 999.99));
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_ERR_CLOCK, attempt_warm(20.0 + 1000.01));
}

/* A coordinate 10 m off, on a scale that is read to 0.1 nm. */
void test_a_start_beyond_the_counter_is_refused_by_the_firmware(void)
{
    controller.two_touches = 0;
    chain.resolution_um = 1e-4;
    touch.approach_mm = 1.0;
    sim_setting_t scale = {.parameters = {5000.0}};
    sim_rig_t     bent = rig;
    while (strcmp(sim_effect_describe((uint32_t)scale.effect)->id, "scale_error") != 0) {
        ++scale.effect;
    }
    bent.settings = &scale;
    bent.settings_count = 1u;
    touch.position_mm = 1e7;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, sim_play(&bent, &touch, 1u, 1u, 1u, &outcome));

    TEST_ASSERT_EQUAL_INT32(SIM_STATUS_MISSED, outcome.status); /* the firmware refuses to start */
    TEST_ASSERT_EQUAL_INT32(TOUCH_ERR_CONFIG, outcome.error);
}

void test_every_refusal_has_a_sentence_of_its_own(void)
{
    for (int code = SIM_PLAY_OK; code >= SIM_PLAY_ERR_CLOCK; --code) {
        TEST_ASSERT_GREATER_THAN_size_t(5u, strlen(sim_play_error(code)));
        TEST_ASSERT_NOT_EQUAL(0, strcmp(sim_play_error(code), sim_play_error(1)));
        for (int other = code + 1; other <= SIM_PLAY_OK; ++other) {
            TEST_ASSERT_NOT_EQUAL(0, strcmp(sim_play_error(code), sim_play_error(other)));
        }
    }
}

/* Every outcome that was not recorded is told as such. */
void test_a_missed_touch_has_no_figures(void)
{
    controller.two_touches = 0;
    touch.path = SIM_PATH_PLC;
    touch.pulse_us = 1.0;
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, attempt(1u));

    TEST_ASSERT_EQUAL_INT32(SIM_STATUS_MISSED, outcome.status);
    TEST_ASSERT_TRUE(isnan(outcome.latch_us) && isnan(outcome.report_us));
    TEST_ASSERT_TRUE(isnan(outcome.deviation_um) && isnan(outcome.overtravel_um));
    TEST_ASSERT_TRUE(isnan(outcome.cycle_s));
    TEST_ASSERT_FALSE(isnan(outcome.true_edge_us));
}
