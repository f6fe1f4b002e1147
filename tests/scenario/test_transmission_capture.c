/*
 * A gear train turns, its encoders drive the two pulse lines of the simulated rig, and the firmware
 * takes what the port has captured: eccentricity and play come out as they were put in.
 */
/* LINK: host_sim/tests/pulse_lines.c $(OUT)/libskiplatch_sim.a */
#include <math.h>

#include "../contract/pulse_lines_under_test.h"
#include "gear_train.h"
#include "hal_error.h"
#include "hal_pulse.h"
#include "transmission/pulse_intake.h"
#include "unity.h"

#define NEAR_WRAP       (UINT32_MAX - 2000000u) /* half a second of 250 ns */
#define ARCSEC_PER_TURN 1296000.0
#define NAS_PER_ARCSEC  1e9
#define CHANNELS        3u
#define FALLING         64u
#define PI              3.141592653589793
#define ECCENTRIC_UM    20.0
#define RADIUS_MM       20.0 /* of the driven gear: 40 teeth of module 1 */
#define PLAY_UM         15.0
#define WITHIN_ARCSEC   1.5 /* ticks of 250 ns at 2 rev/s of the output are 0.65" each */

static const transmission_config_t CHAIN = {
    .method = TRANSMISSION_SUBDIVIDED,
    .lines1 = 1000u,
    .lines2 = 360u,
    .ratio_over = 4u,
    .ratio_under = 1u,
    .meter_ticks = 1u,
};

typedef struct {
    double   least;
    double   most;
    double   sum;
    unsigned count;
} values_t;

static sim_gear_train_t train;
static pulse_intake_t   intake;
static values_t         values[2]; /* forward, backward; each part less its first value */
static uint32_t         part;
static double           zero_arcsec;
static bool             has_turned;

void setUp(void)
{
    train = (sim_gear_train_t){
        .stages = {{.driver = {.teeth = 10.0}, .driven = {.teeth = 40.0}, .module_mm = 1.0}},
        .input = {.lines = 1000.0, .radius_mm = 25.0},
        .output = {.lines = 360.0, .radius_mm = 25.0},
        .speed_rev_s = 2.0,
        .turns = 12.0,
        .clock_hz = 1e9,
        .seed = 1u,
        .stage_count = 1,
    };
    pulse_lines_power_up(NEAR_WRAP);
    values[0] = values[1] = (values_t){.least = INFINITY, .most = -INFINITY};
    TEST_ASSERT_EQUAL_INT(TRANSMISSION_OK, pulse_intake_init(&intake, &CHAIN));
    TEST_ASSERT_EQUAL_INT(HAL_OK, hal_pulse_start(HAL_PULSE_RISING));
}

void tearDown(void)
{
    hal_pulse_stop();
}

static void take_point(double arcsec)
{
    values_t *of = &values[intake.is_backward != has_turned]; /* the first is of before */
    has_turned = false;
    if (part != intake.parts || values[0].count == 0u) {
        part = intake.parts;
        zero_arcsec = arcsec;
    }
    of->least = fmin(of->least, arcsec - zero_arcsec);
    of->most = fmax(of->most, arcsec - zero_arcsec);
    of->sum += arcsec - zero_arcsec;
    ++of->count;
}

static void take_pulses(void)
{
    for (unsigned i = 0u; i < PULSES.held_most; ++i) {
        uint8_t found = pulse_intake_poll(&intake);
        for (uint8_t k = 0u; k < found; ++k) {
            transmission_point_t point = transmission_point(&intake.core, k);
            take_point((double)point.delta_nas / NAS_PER_ARCSEC);
        }
    }
}

/* A mark has an edge at each flank; without one a line is a short pulse. */
static void set_line(uint8_t code)
{
    uint8_t              channel = (uint8_t)((code & CHANNELS) - 1u);
    const sim_encoder_t *encoder = channel == 0u ? &train.input : &train.output;
    bool                 has_mark = encoder->mark > 0.0;
    pulse_line_set(channel, !has_mark || (code & FALLING) == 0u);
    if (!has_mark) {
        pulse_line_set(channel, false);
    }
}

/* Play the train on the lines; the task looks every so many pulses. */
static void play(unsigned pulses_between_polls)
{
    sim_gear_run_t run;
    uint8_t        channel = 0u;
    int64_t        t_ns = 0;
    int64_t        now_us = 0;
    TEST_ASSERT_EQUAL_INT(SIM_GEAR_OK, sim_gear_start(&run, &train));
    for (unsigned i = 1u; sim_gear_pulses(&run, 1u, &channel, &t_ns) == 1u; ++i) {
        bool is_backward = (channel & TRANSMISSION_BACKWARD) != 0u;
        if (is_backward != intake.is_backward) {
            take_pulses();
            TEST_ASSERT_EQUAL_INT(HAL_OK, pulse_intake_turn(&intake, is_backward));
            has_turned = true;
        }
        int64_t left_us = t_ns / 1000 - now_us;
        pulse_lines_pass_us((uint32_t)left_us);
        now_us += left_us;
        set_line(channel);
        if (i % pulses_between_polls == 0u) {
            take_pulses();
        }
    }
    take_pulses();
}

static void check_nothing_lost(void)
{
    TEST_ASSERT_EQUAL_UINT32(0u, intake.lost);
    TEST_ASSERT_EQUAL_UINT32(0u, intake.parts);
    for (uint8_t channel = TRANSMISSION_INPUT; channel <= TRANSMISSION_OUTPUT; ++channel) {
        pulse_counters_t found = transmission_counters(&intake.core, channel);
        TEST_ASSERT_EQUAL_UINT32(0u, found.missing + found.extra + found.slips);
    }
}

/* An eccentric gear leads and lags by e/r once a turn. */
void test_an_eccentric_gear_shows_across_the_wrap_of_the_clock(void)
{
    train.stages[0].driven.eccentricity_um = ECCENTRIC_UM;

    play(5u);

    double expected = 2.0 * ECCENTRIC_UM / (RADIUS_MM * 1000.0) / (2.0 * PI) * ARCSEC_PER_TURN;
    TEST_ASSERT_GREATER_THAN_UINT(1050u, values[0].count);
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * WITHIN_ARCSEC, expected, values[0].most - values[0].least);
    check_nothing_lost();
}

/* The task may be late, as long as the port has room. */
void test_a_late_task_changes_nothing(void)
{
    train.stages[0].driven.eccentricity_um = ECCENTRIC_UM;
    play(1u);
    values_t prompt = values[0];
    setUp();
    train.stages[0].driven.eccentricity_um = ECCENTRIC_UM;

    play(PULSES.held_most);

    TEST_ASSERT_EQUAL_UINT(prompt.count, values[0].count);
    TEST_ASSERT_EQUAL_DOUBLE(prompt.least, values[0].least);
    TEST_ASSERT_EQUAL_DOUBLE(prompt.most, values[0].most);
    check_nothing_lost();
}

/* A task that is too late loses pulses; it says so, and no step comes of it. */
void test_lost_pulses_are_told_and_leave_no_step(void)
{
    play(PULSES.held_most + 40u);

    TEST_ASSERT_GREATER_THAN_UINT32(0u, intake.parts);
    TEST_ASSERT_GREATER_THAN_UINT32(30u * intake.parts, intake.lost);
    TEST_ASSERT_TRUE(fmax(values[0].most, -values[0].least) < WITHIN_ARCSEC);
}

void test_play_shows_when_the_train_turns_back(void)
{
    train.stages[0].play_um = PLAY_UM;
    train.both_senses = 1;

    play(5u);

    double expected = PLAY_UM / (RADIUS_MM * 1000.0) / (2.0 * PI) * ARCSEC_PER_TURN;
    double found = values[1].sum / values[1].count - values[0].sum / values[0].count;
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN_ARCSEC, expected, found);
}

/* Rising edges in both senses would show 172" more: the marks are 0.3 and 0.62 of a line wide. */
void test_the_width_of_the_marks_is_no_play(void)
{
    const double turns[] = {12.0, 12.0002, 12.0005, 12.008};
    for (unsigned i = 0u; i < sizeof turns / sizeof *turns; ++i) {
        setUp();
        train.stages[0].play_um = PLAY_UM;
        train.input.mark = 0.3;
        train.output.mark = 0.62;
        train.turns = turns[i];
        train.speed_rev_s = 1.9371; /* lines pass anywhere within a tick */
        train.both_senses = 1;

        play(5u);

        double expected = PLAY_UM / (RADIUS_MM * 1000.0) / (2.0 * PI) * ARCSEC_PER_TURN;
        double found = values[1].sum / values[1].count - values[0].sum / values[0].count;
        TEST_ASSERT_DOUBLE_WITHIN(0.1, expected, found);
        check_nothing_lost();
    }
}
