/* What is drawn at random is distributed as the nominal chain says, and each quantity on its own.
 */
/* LINK: tests/support/play.c tests/support/dice.c tests/support/statistics.c
 *       $(OUT)/libskiplatch_sim.a */
#include <math.h>

#include "dice.h"
#include "play.h"
#include "statistics.h"
#include "unity.h"

#define N 100000u

static sim_chain_t   chain;
static sim_touch_t   touches[N];
static sim_outcome_t outcomes[N];
static double        values[N];
static double        others[N];

void setUp(void)
{
    chain = PLAY_BENCH;
    chain.skip_jitter_us = 100.0;
    chain.report_jitter_us = 200.0;
    chain.reference_jitter_us = 3.0;
}

void tearDown(void)
{
}

/* Touches at random instants, all on one path. */
static void play_touches(int32_t path)
{
    dice_t dice = dice_seed(11u);
    for (unsigned i = 0u; i < N; ++i) {
        touches[i] = play_touch(i, path, 0.6 * i + dice_between(&dice, 0.0, 0.1));
    }
    play(&chain, &PLAY_ONE_TOUCH, touches, N, outcomes);
    play_check_ok(outcomes, N);
}

static int play_as(uint64_t seed, uint64_t replicate, uint64_t n, uint64_t replicates,
                   sim_outcome_t *to)
{
    const sim_rig_t rig = {
        .chain = &chain, .controller = &PLAY_ONE_TOUCH, .seed = seed, .replicate = replicate};
    return sim_play(&rig, touches, n, replicates, 1u, to);
}

static double latch_share(const sim_outcome_t *o)
{
    return (o->latch_us - o->true_edge_us - chain.skip_latency_us) / chain.skip_jitter_us;
}

static double report_share(const sim_outcome_t *o)
{
    return (o->report_us - o->latch_us - chain.report_latency_us) / chain.report_jitter_us;
}

static double scan_share(const sim_outcome_t *o)
{
    return (o->latch_us - o->true_edge_us) / chain.scan_us;
}

static double reference_share(const sim_outcome_t *o)
{
    return (o->edge_us - o->true_edge_us) / chain.reference_jitter_us;
}

static void collect(double (*share)(const sim_outcome_t *), double *into)
{
    for (unsigned i = 0u; i < N; ++i) {
        into[i] = share(&outcomes[i]);
    }
}

/* Times are in whole nanoseconds: the middle of each takes the place of its end. */
static void collect_in_range(double (*share)(const sim_outcome_t *), double width_us, double *into)
{
    collect(share, into);
    for (unsigned i = 0u; i < N; ++i) {
        into[i] = fmin(fmax(into[i], 1e-4 / width_us), 1.0 - 1e-4 / width_us);
    }
}

static void check_no_further_out(double (*share)(const sim_outcome_t *), double width_us)
{
    double slack = 0.0011 / width_us;
    collect(share, values);
    for (unsigned i = 0u; i < N; ++i) {
        TEST_ASSERT_TRUE(values[i] >= -slack && values[i] <= 1.0 + slack);
    }
}

void test_the_latency_of_the_skip_input_is_uniform_in_its_jitter(void)
{
    play_touches(SIM_PATH_SKIP);
    check_no_further_out(latch_share, chain.skip_jitter_us);

    collect_in_range(latch_share, chain.skip_jitter_us, values);
    statistics_check_uniform(values, N);
}

void test_the_travel_of_a_report_is_uniform_in_its_jitter(void)
{
    for (int32_t path = SIM_PATH_SKIP; path <= SIM_PATH_PLC; ++path) {
        play_touches(path);
        check_no_further_out(report_share, chain.report_jitter_us);

        collect_in_range(report_share, chain.report_jitter_us, values);
        statistics_check_uniform(values, N);
    }
}

void test_edges_at_random_instants_fall_anywhere_in_a_scan(void)
{
    play_touches(SIM_PATH_PLC);
    check_no_further_out(scan_share, chain.scan_us);

    collect_in_range(scan_share, chain.scan_us, values);
    statistics_check_uniform(values, N);
}

void test_the_scans_of_different_campaigns_begin_anywhere(void)
{
    touches[0] = play_touch(0u, SIM_PATH_PLC, 1.0);
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, play_as(PLAY_SEED, 0u, 1u, N, outcomes));

    collect_in_range(scan_share, chain.scan_us, values);
    statistics_check_uniform(values, N);
}

void test_the_scans_of_different_seeds_begin_anywhere(void)
{
    touches[0] = play_touch(0u, SIM_PATH_PLC, 1.0);
    for (unsigned i = 0u; i < N; ++i) {
        TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, play_as(i, 0u, 1u, 1u, &outcomes[i]));
    }

    collect_in_range(scan_share, chain.scan_us, values);
    statistics_check_uniform(values, N);
}

void test_the_noise_of_the_reference_is_normal(void)
{
    play_touches(SIM_PATH_SKIP);

    collect(reference_share, values);
    statistics_check_normal(values, N);
}

void test_the_repeatability_of_a_probe_is_normal(void)
{
    chain = PLAY_MACHINE;
    sim_touch_t touch = play_touch(0u, SIM_PATH_SKIP, 0.0);
    play(&chain, &PLAY_ONE_TOUCH, &touch, 1u, outcomes);
    double without_us = outcomes[0].true_edge_us;
    chain.repeatability_um = 2.0;
    play_touches(SIM_PATH_SKIP);
    for (unsigned i = 0u; i < N; ++i) {
        double way_us = outcomes[i].true_edge_us - rint(touches[i].time_s * 1e9) * 1e-3;
        values[i] = (way_us - without_us) * 0.01 / chain.repeatability_um;
    }

    statistics_check_normal(values, N);
}

void test_a_pretravel_is_never_below_zero(void)
{
    chain = PLAY_MACHINE;
    chain.pretravel_um = 1.0;
    chain.repeatability_um = 2.0;
    chain.delay_us = 0.0;
    play_touches(SIM_PATH_SKIP);
    unsigned at_zero = 0u;
    for (unsigned i = 0u; i < N; ++i) {
        double over_um =
            outcomes[i].deviation_um - 0.01 * (chain.filter_us + chain.skip_latency_us);
        TEST_ASSERT_TRUE(over_um > -0.0011);
        at_zero += over_um < 0.0011 ? 1u : 0u;
    }

    double share =
        0.5 * erfc(0.5 / sqrt(2.0)); /* of a normal quantity more than 1/2 σ below its mean */
    TEST_ASSERT_DOUBLE_WITHIN(5.0 * sqrt(N * share * (1.0 - share)) + 0.001 * N, N * share,
                              at_zero);
}

void test_the_quantities_of_a_touch_are_independent(void)
{
    play_touches(SIM_PATH_SKIP);
    collect(latch_share, values);
    collect(report_share, others);
    statistics_check_independent(values, others, N);

    collect(reference_share, others);
    statistics_check_independent(values, others, N);
}

void test_neighbouring_touches_and_replicates_are_independent(void)
{
    play_touches(SIM_PATH_SKIP);
    collect(latch_share, values);
    statistics_check_independent(values, &values[1], N - 1u);
    TEST_ASSERT_EQUAL_INT(SIM_PLAY_OK, play_as(PLAY_SEED, 1u, N, 1u, outcomes));
    collect(latch_share, others);

    statistics_check_independent(values, others, N);
}
