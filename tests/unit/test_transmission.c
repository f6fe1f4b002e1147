/* The five methods on trains whose error is known: how near they come, and that nothing drifts. */
/* LINK: firmware/comp/transmission*.c
 *       firmware/comp/pulse_judge.c firmware/comp/phase_meter.c
 *       tests/support/encoders.c tests/support/chain_run.c */
#include <math.h>

#include "chain_run.h"
#include "unity.h"

#define TURN       3600.0 /* lines of the output */
#define AMPLITUDE  (9.57 / 2.0)
#define WITHIN     0.02
#define QUANTUM    15.8
#define LINE_INPUT (ENCODERS_ARCSEC_PER_TURN / 1024.0 / 40.7) /* at the output */

static const encoders_setup_t CHAIN = {
    .lines1 = 1024.0,
    .lines2 = TURN,
    .ratio = 40.7,
    .input_rev_per_s = 5.0,
    .error_arcsec = AMPLITUDE,
    .phase = 0.3,
    .tick_s = 1.0e-7,
};
static const transmission_config_t CONFIG = {
    .lines1 = 1024u,
    .lines2 = 3600u,
    .ratio_over = 407u,
    .ratio_under = 10u,
    .range = 2u,
    .meter_ticks = 1u,
};
/* i = 40 with 900 lines: ten input lines to an output line, so that dividers give a frequency. */
static const encoders_setup_t EVEN_CHAIN = {
    .lines1 = 900.0,
    .lines2 = TURN,
    .ratio = 40.0,
    .input_rev_per_s = 5.0,
    .error_arcsec = 40.0,
    .phase = 0.3,
    .tick_s = 1.0e-7,
};
static const transmission_config_t EVEN_CONFIG = {
    .lines1 = 900u,
    .lines2 = 3600u,
    .ratio_over = 40u,
    .ratio_under = 1u,
    .range = 2u,
    .meter_ticks = 1u,
};

static chain_run_t run;
static encoders_t  encoders;

void setUp(void)
{
}

void tearDown(void)
{
}

static void start(const encoders_setup_t *chain, const transmission_config_t *config,
                  transmission_method_t method)
{
    transmission_config_t with_method = *config;
    with_method.method = method;
    chain_run_start(&run, chain, &with_method);
    encoders_start(&encoders, &run.setup);
}

static void check_untouched(uint8_t channel)
{
    pulse_counters_t found = transmission_counters(&run.core, channel);
    TEST_ASSERT_EQUAL_UINT32(0u, found.missing);
    TEST_ASSERT_EQUAL_UINT32(0u, found.extra);
    TEST_ASSERT_EQUAL_UINT32(0u, found.slips);
}

static void check_nothing_missing_or_extra(void)
{
    check_untouched(TRANSMISSION_INPUT);
    check_untouched(TRANSMISSION_OUTPUT);
}

/* ---- counting methods ---- */

void test_subdivided_counting_finds_every_point_of_the_planted_error(void)
{
    start(&CHAIN, &CONFIG, TRANSMISSION_SUBDIVIDED);

    chain_run_lines(&run, &encoders, 3.0 * TURN);

    TEST_ASSERT_TRUE(run.points > 3.0 * TURN - 5.0);
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
    check_nothing_missing_or_extra();
}

void test_direct_counting_stays_within_its_quantum_and_needs_all_of_it(void)
{
    start(&CHAIN, &CONFIG, TRANSMISSION_DIRECT);

    chain_run_lines(&run, &encoders, 3.0 * TURN);

    TEST_ASSERT_DOUBLE_WITHIN(QUANTUM, 0.0, chain_run_off(&run));
    TEST_ASSERT_TRUE(chain_run_off(&run) > 0.49 * LINE_INPUT);
}

/* Half a line is added for the part that is not seen, so that on the whole nothing is off. */
void test_direct_counting_is_right_in_the_mean(void)
{
    start(&CHAIN, &CONFIG, TRANSMISSION_SUBDIVIDED);
    chain_run_lines(&run, &encoders, TURN);
    double subdivided = chain_run_mean_off(&run);
    start(&CHAIN, &CONFIG, TRANSMISSION_DIRECT);

    chain_run_lines(&run, &encoders, TURN);

    TEST_ASSERT_DOUBLE_WITHIN(0.1, subdivided, chain_run_mean_off(&run));
}

static void check_no_drift(transmission_method_t method, double turns, double within)
{
    start(&CHAIN, &CONFIG, method);
    chain_run_lines(&run, &encoders, TURN);
    double first = chain_run_mean_off(&run);
    chain_run_lines(&run, &encoders, (turns - 1.0) * TURN);
    chain_run_look_again(&run);

    chain_run_lines(&run, &encoders, turns * TURN);

    TEST_ASSERT_DOUBLE_WITHIN(2.0, turns * TURN - 1.0, run.last.line);
    TEST_ASSERT_DOUBLE_WITHIN(within, first, chain_run_mean_off(&run));
    check_nothing_missing_or_extra();
}

/* The clock of 10 MHz goes round nineteen times meanwhile. */
void test_subdivided_counting_does_not_drift_in_a_thousand_turns(void)
{
    check_no_drift(TRANSMISSION_SUBDIVIDED, 1000.0, 0.001);
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
}

void test_direct_counting_does_not_drift(void)
{
    check_no_drift(TRANSMISSION_DIRECT, 100.0, 0.1);
}

static void check_the_clock_going_round(transmission_method_t method)
{
    encoders_setup_t chain = CHAIN;
    start(&chain, &CONFIG, method);
    chain_run_lines(&run, &encoders, 40.0);
    transmission_point_t unwrapped = run.last;
    for (uint32_t before = 0u; before < 40000u; before += 997u) {
        chain.start_ticks = UINT32_MAX - before;
        start(&chain, &CONFIG, method);

        chain_run_lines(&run, &encoders, 40.0);

        TEST_ASSERT_EQUAL_INT64(unwrapped.delta_nas, run.last.delta_nas);
        TEST_ASSERT_EQUAL_UINT32(unwrapped.ticks + chain.start_ticks, run.last.ticks);
        check_nothing_missing_or_extra();
    }
}

void test_a_clock_that_goes_round_changes_nothing(void)
{
    check_the_clock_going_round(TRANSMISSION_SUBDIVIDED);
    check_the_clock_going_round(TRANSMISSION_DIRECT);
    check_the_clock_going_round(TRANSMISSION_PHASE_SUBDIVIDED);
}

void test_speed_ripple_is_followed_by_the_subdivision(void)
{
    encoders_setup_t chain = CHAIN;
    chain.ripple = 0.2;
    start(&chain, &CONFIG, TRANSMISSION_SUBDIVIDED);

    chain_run_lines(&run, &encoders, TURN);

    TEST_ASSERT_DOUBLE_WITHIN(1.3 * WITHIN, 0.0, chain_run_off(&run)); /* faster: coarser ticks */
    check_nothing_missing_or_extra();
}

/* Lines of the output are then the denser ones, and the input's gate. */
void test_the_denser_train_may_be_the_output(void)
{
    encoders_setup_t chain = CHAIN;
    chain.lines1 = 50.0;
    transmission_config_t config = CONFIG;
    config.lines1 = 50u;
    start(&chain, &config, TRANSMISSION_SUBDIVIDED);

    chain_run_lines(&run, &encoders, 2.0 * TURN);

    TEST_ASSERT_FALSE(run.core.gate_is_output);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 2.0 * AMPLITUDE, run.highest - run.lowest);
    check_nothing_missing_or_extra();
}

/* ---- phase comparison ---- */

void test_subdivided_phase_comparison_finds_every_point_of_the_planted_error(void)
{
    start(&CHAIN, &CONFIG, TRANSMISSION_PHASE_SUBDIVIDED);

    chain_run_lines(&run, &encoders, 3.0 * TURN);

    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
}

void test_subdivided_phase_comparison_goes_on_past_a_whole_period(void)
{
    encoders_setup_t chain = CHAIN;
    chain.error_arcsec = 1000.0; /* 32 lines of the input */
    start(&chain, &CONFIG, TRANSMISSION_PHASE_SUBDIVIDED);

    chain_run_lines(&run, &encoders, 2.0 * TURN);

    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
}

void test_digital_phase_comparison_finds_the_error_within_its_range(void)
{
    start(&EVEN_CHAIN, &EVEN_CONFIG, TRANSMISSION_PHASE_DIGITAL);

    chain_run_lines(&run, &encoders, 2.0 * TURN);

    TEST_ASSERT_TRUE(run.points > TURN - 5.0); /* one in two lines */
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, chain_run_off(&run));
}

void test_digital_phase_comparison_folds_what_is_past_its_range(void)
{
    encoders_setup_t chain = EVEN_CHAIN;
    chain.error_arcsec = 800.0; /* the range is two lines of the output: ± 360" */
    start(&chain, &EVEN_CONFIG, TRANSMISSION_PHASE_DIGITAL);

    chain_run_lines(&run, &encoders, 2.0 * TURN);

    TEST_ASSERT_DOUBLE_WITHIN(2.0, 720.0, run.highest - run.lowest);
}

void test_the_range_is_bought_with_points(void)
{
    encoders_setup_t chain = EVEN_CHAIN;
    chain.error_arcsec = 800.0;
    transmission_config_t config = EVEN_CONFIG;
    config.range = 6u;
    start(&chain, &config, TRANSMISSION_PHASE_DIGITAL);

    chain_run_lines(&run, &encoders, 2.0 * TURN);

    TEST_ASSERT_TRUE(run.points < 2.0 * TURN / 6.0 + 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(10.0, 1600.0, run.highest - run.lowest);
}

/* Wherever the lines of the two encoders lie to each other. */
void test_without_a_range_of_its_own_equal_trains_are_not_folded(void)
{
    encoders_setup_t chain = EVEN_CHAIN;
    chain.lines1 = TURN;
    chain.ratio = 1.0;
    transmission_config_t config = {
        .lines1 = 3600u, .lines2 = 3600u, .ratio_over = 1u, .ratio_under = 1u, .meter_ticks = 1u};
    for (int shift = 0; shift < 8; ++shift) {
        chain.phase = shift / 8.0;
        start(&chain, &config, TRANSMISSION_PHASE_DIGITAL);

        chain_run_lines(&run, &encoders, 2.0 * TURN);

        TEST_ASSERT_DOUBLE_WITHIN(2.0, 80.0, run.highest - run.lowest);
    }
}

/* The lag is held against the period before: a change of speed shows as an error. */
void test_digital_phase_comparison_takes_speed_ripple_for_an_error(void)
{
    encoders_setup_t chain = EVEN_CHAIN;
    chain.ripple = 0.05;
    start(&chain, &EVEN_CONFIG, TRANSMISSION_PHASE_SUBDIVIDED);
    chain_run_lines(&run, &encoders, 2.0 * TURN);
    double subdivided = chain_run_off(&run);
    start(&chain, &EVEN_CONFIG, TRANSMISSION_PHASE_DIGITAL);

    chain_run_lines(&run, &encoders, 2.0 * TURN);

    TEST_ASSERT_TRUE(subdivided < 0.1);
    TEST_ASSERT_TRUE(chain_run_off(&run) > 1.0);
}

static double analog_amplitude(uint32_t meter_ticks)
{
    transmission_config_t config = EVEN_CONFIG;
    config.meter_ticks = meter_ticks;
    start(&EVEN_CHAIN, &config, TRANSMISSION_PHASE_ANALOG);
    double settled = ceil(8.0 * meter_ticks * 1.0e-7 / 8.0 + 1.0) * TURN;
    chain_run_lines(&run, &encoders, settled);
    chain_run_look_again(&run);
    chain_run_lines(&run, &encoders, settled + TURN);
    return 0.5 * (run.highest - run.lowest);
}

/* An output turn takes 8 s: a first-order meter of time constant T passes 1/sqrt(1 + (2 pi T/8)^2).
 */
void test_the_analog_meter_damps_what_is_faster_than_its_needle(void)
{
    static const double constants_s[] = {0.1, 1.0, 4.0};
    for (int i = 0; i < 3; ++i) {
        double omega_tau = 2.0 * 3.14159265358979 * constants_s[i] / 8.0;

        double amplitude = analog_amplitude((uint32_t)(constants_s[i] * 1.0e7));

        TEST_ASSERT_DOUBLE_WITHIN(0.4, 40.0 / sqrt(1.0 + omega_tau * omega_tau), amplitude);
    }
}

/* ---- refusals ---- */

static void check_refused(int expected, transmission_config_t config)
{
    transmission_t core;
    TEST_ASSERT_EQUAL(expected, transmission_init(&core, &config));
}

void test_a_set_up_without_sense_is_refused(void)
{
    transmission_config_t config = CONFIG;
    config.lines1 = 0u;
    check_refused(TRANSMISSION_ERR_LINES, config);
    config.lines1 = (1u << 24) + 1u;
    check_refused(TRANSMISSION_ERR_LINES, config);
    config = CONFIG;
    config.lines2 = 0u;
    check_refused(TRANSMISSION_ERR_LINES, config);
    config = CONFIG;
    config.ratio_over = 0u;
    check_refused(TRANSMISSION_ERR_RATIO, config);
    config = CONFIG;
    config.ratio_under = 0u;
    check_refused(TRANSMISSION_ERR_RATIO, config);
    config = CONFIG;
    config.range = UINT32_MAX;
    config.method = TRANSMISSION_PHASE_DIGITAL;
    check_refused(TRANSMISSION_ERR_METER, config);
    config = CONFIG;
    config.meter_ticks = 0u;
    check_refused(TRANSMISSION_ERR_METER, config);
    config = CONFIG;
    config.method = (transmission_method_t)5;
    check_refused(TRANSMISSION_ERR_METHOD, config);
}

void test_a_fraction_that_does_not_fit_is_refused(void)
{
    transmission_config_t config = CONFIG;
    config.ratio_over = 2147483647u; /* a prime: nothing cancels */
    config.ratio_under = 2147483629u;
    check_refused(TRANSMISSION_ERR_RANGE, config);
    config = (transmission_config_t){.lines1 = 1u << 20,
                                     .lines2 = 1u,
                                     .ratio_over = 1u,
                                     .ratio_under = 1u,
                                     .range = 1u,
                                     .meter_ticks = 1u};
    check_refused(TRANSMISSION_ERR_RANGE, config);
    config.lines1 -= 1u;
    check_refused(TRANSMISSION_OK, config);
}
