/* The simulated gear train: when lines pass, worked out by hand. */
/* LINK: host_sim/gear_*.c host_sim/random.c */
#include "gear_train.h"

#include <math.h>

#include "unity.h"

#define ROOM     200000u
#define BACKWARD 128u

static sim_gear_train_t train;
static sim_gear_run_t   run;
static uint8_t          channels[ROOM];
static int64_t          t_ns[ROOM];

void setUp(void)
{
    train = (sim_gear_train_t){
        .stages = {{.driver = {.teeth = 10.0}, .driven = {.teeth = 40.0}, .module_mm = 1.0}},
        .input = {.lines = 100.0, .radius_mm = 25.0},
        .output = {.lines = 360.0, .radius_mm = 25.0},
        .speed_rev_s = 5.0,
        .turns = 40.0,
        .clock_hz = 1e9,
        .seed = 1u,
        .stage_count = 1};
}

void tearDown(void)
{
}

static uint64_t turn(void)
{
    TEST_ASSERT_EQUAL(SIM_GEAR_OK, sim_gear_start(&run, &train));
    uint64_t n = sim_gear_pulses(&run, ROOM, channels, t_ns);
    TEST_ASSERT_LESS_THAN_UINT64(ROOM, n);
    return n;
}

/* Time of pulse `serial`, from 1, of a channel. */
static double time_of(uint64_t n, uint8_t channel, uint32_t serial)
{
    for (uint64_t i = 0u; i < n; ++i) {
        if (channels[i] == channel && --serial == 0u) {
            return (double)t_ns[i];
        }
    }
    TEST_FAIL_MESSAGE("no such pulse");
    return 0.0;
}

static uint32_t count_of(uint64_t n, uint8_t channel)
{
    uint32_t count = 0u;
    for (uint64_t i = 0u; i < n; ++i) {
        count += channels[i] == channel ? 1u : 0u;
    }
    return count;
}

void test_lines_of_a_perfect_train_pass_evenly(void)
{
    uint64_t n = turn();

    TEST_ASSERT_DOUBLE_WITHIN(2.0, 777.0 / 100.0 / 5.0 * 1e9, time_of(n, 1u, 777u));
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 777.0 / 360.0 * 4.0 / 5.0 * 1e9, time_of(n, 2u, 777u));
}

void test_pulses_come_in_order_and_in_ticks(void)
{
    train.clock_hz = 1e7;
    train.input.jitter_ns = 3000.0;
    train.output.jitter_ns = 3000.0;

    uint64_t n = turn();

    for (uint64_t i = 1u; i < n; ++i) {
        TEST_ASSERT_TRUE(t_ns[i] >= t_ns[i - 1u]);
        TEST_ASSERT_EQUAL_INT64(0, t_ns[i] % 100);
    }
}

void test_an_eccentric_wheel_is_behind_by_its_way_after_a_quarter_turn(void)
{
    train.stages[0].driven.eccentricity_um = 10.0;

    uint64_t n = turn();

    /* 10 um more flank than there should be: the wheel is that much behind. */
    double behind_turns = 10.0 / (3.14159265358979 * 40.0 * 1000.0);
    double expected = (90.0 / 360.0 + behind_turns) * 4.0 / 5.0 * 1e9;
    TEST_ASSERT_DOUBLE_WITHIN(3.0, expected, time_of(n, 2u, 90u));
}

void test_the_mean_speed_survives_a_ripple(void)
{
    train.speed_ripple = 0.5;
    train.speed_ripple_hz = 5.0;

    uint64_t n = turn();

    /* After whole periods of the ripple everything is where it would be without. */
    TEST_ASSERT_DOUBLE_WITHIN(3.0, 1e9, time_of(n, 1u, 500u));
    TEST_ASSERT_TRUE(fabs(time_of(n, 1u, 550u) - 1.1e9) > 1e6);
}

void test_turning_back_passes_every_line_again(void)
{
    train.both_senses = 1;
    train.stages[0].play_um = 50.0;

    uint64_t n = turn();

    TEST_ASSERT_UINT32_WITHIN(1u, count_of(n, 1u), count_of(n, 1u + BACKWARD));
    TEST_ASSERT_UINT32_WITHIN(1u, count_of(n, 2u), count_of(n, 2u + BACKWARD));
}

void test_the_output_waits_for_the_play_when_turning_back(void)
{
    train.both_senses = 1;
    uint64_t n = turn();
    double   without = time_of(n, 2u + BACKWARD, 100u);
    train.stages[0].play_um = 50.0;

    n = turn();

    double play_s = 50.0 / (3.14159265358979 * 40.0 * 1000.0) * 4.0 / 5.0;
    TEST_ASSERT_DOUBLE_WITHIN(3.0, play_s * 1e9, time_of(n, 2u + BACKWARD, 100u) - without);
}

void test_a_run_goes_on_from_block_to_block(void)
{
    uint64_t n = turn();
    int64_t  last = t_ns[n - 1u];
    TEST_ASSERT_EQUAL(SIM_GEAR_OK, sim_gear_start(&run, &train));
    uint64_t all = 0u;
    uint64_t got = 0u;
    int64_t  latest = 0;

    do {
        got = sim_gear_pulses(&run, 7u, channels, t_ns);
        all += got;
        latest = got > 0u ? t_ns[got - 1u] : latest;
    } while (got == 7u);

    TEST_ASSERT_EQUAL_UINT64(n, all);
    TEST_ASSERT_EQUAL_INT64(last, latest);
}

void test_what_cannot_turn_is_refused(void)
{
    sim_gear_train_t good = train;

    train.stage_count = 5;
    TEST_ASSERT_EQUAL(SIM_GEAR_ERR_STAGES, sim_gear_start(&run, &train));
    train = good;
    train.stages[0].driven.teeth = (double)NAN;
    TEST_ASSERT_EQUAL(SIM_GEAR_ERR_STAGES, sim_gear_start(&run, &train));
    train = good;
    train.output.lines = 0.0;
    TEST_ASSERT_EQUAL(SIM_GEAR_ERR_ENCODER, sim_gear_start(&run, &train));
    train = good;
    train.speed_ripple = 0.95;
    TEST_ASSERT_EQUAL(SIM_GEAR_ERR_MOTION, sim_gear_start(&run, &train));
    train = good;
    train.stages[0].driver.mesh_um = 500.0;
    TEST_ASSERT_EQUAL(SIM_GEAR_ERR_ERRORS, sim_gear_start(&run, &train));
}
