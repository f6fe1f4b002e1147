/* Pulses that are missing or too many, and shafts that start, stop and turn back. */
/* LINK: firmware/comp/transmission*.c
 *       firmware/comp/pulse_judge.c firmware/comp/phase_meter.c
 *       tests/support/encoders.c tests/support/chain_run.c tests/support/dice.c */
#include <math.h>

#include "chain_run.h"
#include "dice.h"
#include "unity.h"

#define LINES  400.0 /* of the output in a run */
#define WITHIN 0.02

static const encoders_setup_t CHAIN = {
    .lines1 = 1024.0,
    .lines2 = 3600.0,
    .ratio = 40.7,
    .input_rev_per_s = 5.0,
    .error_arcsec = 9.57 / 2.0,
    .phase = 0.3,
    .tick_s = 1.0e-7,
    .start_ticks = 4294000000u, /* the clock goes round in between */
};
static const transmission_config_t CONFIG = {
    .lines1 = 1024u,
    .lines2 = 3600u,
    .ratio_over = 407u,
    .ratio_under = 10u,
    .range = 2u,
    .meter_ticks = 1u,
};

static chain_run_t run;
static encoders_t  encoders;

void setUp(void)
{
    chain_run_start(&run, &CHAIN, &CONFIG);
    encoders_start(&encoders, &run.setup);
}

void tearDown(void)
{
}

static void check_found(uint8_t channel, uint32_t missing, uint32_t extra)
{
    pulse_counters_t found = transmission_counters(&run.core, channel);
    TEST_ASSERT_EQUAL_UINT32(missing, found.missing);
    TEST_ASSERT_EQUAL_UINT32(extra, found.extra);
    TEST_ASSERT_EQUAL_UINT32(0u, found.slips);
}

/* Nothing was integrated, and no point shows that anything was wrong. */
static void check_unharmed(void)
{
    TEST_ASSERT_TRUE(run.points > 0.9 * LINES);
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
}

/* Play all but `count` pulses of a train from `first` on. */
static void lose(uint8_t channel, double first, double count)
{
    encoders_pulse_t pulse;
    while (encoders.next_line[1] < LINES && encoders_next(&encoders, &pulse)) {
        if (pulse.channel != channel || pulse.line < first || pulse.line >= first + count) {
            chain_run_pulse(&run, pulse.channel, pulse.ticks);
        }
    }
}

/* Play all pulses and one more, when `ticks` have passed since the start. */
static void add(uint8_t channel, uint32_t ticks, uint32_t count)
{
    encoders_pulse_t pulse;
    while (encoders.next_line[1] < LINES && encoders_next(&encoders, &pulse)) {
        for (; count > 0u && pulse.ticks - run.setup.start_ticks >= ticks; --count) {
            chain_run_pulse(&run, channel, run.setup.start_ticks + ticks);
            ticks += 3u;
        }
        chain_run_pulse(&run, pulse.channel, pulse.ticks);
    }
}

/* ---- missing and extra pulses ---- */

void test_missing_input_pulses_are_counted_and_put_right(void)
{
    for (double count = 1.0; count <= 12.0; count += 1.0) {
        setUp();

        lose(TRANSMISSION_INPUT, 2000.0, count);

        check_found(TRANSMISSION_INPUT, (uint32_t)count, 0u);
        check_found(TRANSMISSION_OUTPUT, 0u, 0u);
        check_unharmed();
    }
}

void test_missing_output_pulses_are_counted_and_put_right(void)
{
    for (double count = 1.0; count <= 12.0; count += 1.0) {
        setUp();

        lose(TRANSMISSION_OUTPUT, 200.0, count);

        check_found(TRANSMISSION_INPUT, 0u, 0u);
        check_found(TRANSMISSION_OUTPUT, (uint32_t)count, 0u);
        check_unharmed();
    }
}

/* A line of the output takes 22612 ticks: whatever the place, also about a pulse of the output. */
void test_an_extra_input_pulse_anywhere_in_a_line_is_left_out(void)
{
    for (uint32_t ticks = 4000000u; ticks < 4000000u + 22612u; ticks += 53u) {
        setUp();

        add(TRANSMISSION_INPUT, ticks, 1u);

        check_found(TRANSMISSION_INPUT, 0u, 1u);
        check_found(TRANSMISSION_OUTPUT, 0u, 0u);
        check_unharmed();
    }
}

void test_an_extra_output_pulse_anywhere_in_a_line_is_left_out(void)
{
    for (uint32_t ticks = 4000000u; ticks < 4000000u + 2u * 22612u; ticks += 211u) {
        setUp();

        add(TRANSMISSION_OUTPUT, ticks, 1u);

        check_found(TRANSMISSION_INPUT, 0u, 0u);
        check_found(TRANSMISSION_OUTPUT, 0u, 1u);
        check_unharmed();
    }
}

/*
 * Play all pulses but one of the input and the third one after it, and one more so many ticks after
 * the line before.
 */
static void replace_input_pulse(double missing, uint32_t after_ticks)
{
    encoders_pulse_t pulse;
    uint32_t         extra_ticks = 0u;
    bool             is_due = false;
    while (encoders.next_line[1] < LINES && encoders_next(&encoders, &pulse)) {
        if (is_due && pulse.ticks - extra_ticks < UINT32_C(1) << 31) {
            chain_run_pulse(&run, TRANSMISSION_INPUT, extra_ticks);
            is_due = false;
        }
        bool is_input = pulse.channel == TRANSMISSION_INPUT;
        if (is_input && pulse.line == missing - 1.0) {
            extra_ticks = pulse.ticks + after_ticks;
            is_due = true;
        }
        if (!is_input || (pulse.line != missing && pulse.line != missing + 3.0)) {
            chain_run_pulse(&run, pulse.channel, pulse.ticks);
        }
        if (is_input && pulse.line == missing + 50.0) {
            chain_run_look_again(&run); /* what lies about it may be off */
        }
    }
}

/* What lies between measured and planted in a run without a fault: where counting began. */
static double zero_arcsec(void)
{
    setUp();
    chain_run_lines(&run, &encoders, LINES);
    double zero = chain_run_mean_off(&run);
    setUp();
    return zero;
}

/*
 * A line of the input takes 1953 ticks. The extra one comes a half between two lines, where the
 * judge has to wait for the next pulse, and must not be thrown out of its time by it.
 */
void test_an_extra_pulse_and_missing_ones_about_it_leave_no_step(void)
{
    double zero = zero_arcsec();
    for (uint32_t ticks = 5u * 1953u / 4u + 20u; ticks < 7u * 1953u / 4u - 20u; ticks += 31u) {
        setUp();

        replace_input_pulse(2000.0, ticks);

        check_found(TRANSMISSION_INPUT, 2u, 1u);
        TEST_ASSERT_DOUBLE_WITHIN(WITHIN, zero, chain_run_mean_off(&run));
        TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
    }
}

/* One in 200 is lost and as many are added, at places that are drawn. */
void test_a_train_with_many_missing_and_extra_pulses_keeps_its_count(void)
{
    double           zero = zero_arcsec();
    dice_t           dice = dice_seed(4u);
    uint32_t         lost = 0u;
    uint32_t         added = 0u;
    encoders_pulse_t pulse;
    while (encoders.next_line[1] < 10.0 * LINES && encoders_next(&encoders, &pulse)) {
        bool is_input = pulse.channel == TRANSMISSION_INPUT && pulse.line > 50.0;
        bool is_lost = is_input && dice_below(&dice, 200u) == 0u;
        lost += is_lost ? 1u : 0u;
        if (!is_lost) {
            chain_run_pulse(&run, pulse.channel, pulse.ticks);
        }
        if (is_input && dice_below(&dice, 200u) == 0u) {
            uint32_t until = 140u; /* before the next pulse of either train */
            chain_run_pulse(&run, TRANSMISSION_INPUT, pulse.ticks + 1u + dice_below(&dice, until));
            ++added;
        }
    }
    chain_run_look_again(&run);
    chain_run_lines(&run, &encoders, 11.0 * LINES);

    pulse_counters_t found = transmission_counters(&run.core, TRANSMISSION_INPUT);
    TEST_ASSERT_GREATER_THAN_UINT32(200u, lost);
    TEST_ASSERT_UINT32_WITHIN(lost / 50u, lost, found.missing);
    TEST_ASSERT_UINT32_WITHIN(added / 50u, added, found.extra);
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, zero, chain_run_mean_off(&run));
}

/* The shaft turns back when a pulse is still in doubt: it was a line. */
void test_a_shaft_that_slows_and_turns_back_loses_no_line(void)
{
    uint32_t ticks = 0u;
    for (uint32_t line = 0u; line < 200u; ++line) {
        ticks += line == 199u ? 1400u : 1000u;
        chain_run_pulse(&run, TRANSMISSION_INPUT, ticks);
    }
    for (uint32_t line = 0u; line < 200u; ++line) {
        ticks += line == 0u ? 2800u : 1000u;
        chain_run_pulse(&run, TRANSMISSION_INPUT | TRANSMISSION_BACKWARD, ticks);
    }

    TEST_ASSERT_EQUAL_INT32(0, run.core.dense.line);
    check_found(TRANSMISSION_INPUT, 0u, 0u);
}

/* i = 40 with 900 lines: a comparison at every line of the output, 22222 ticks. */
void test_an_extra_input_pulse_does_not_shift_a_phase(void)
{
    encoders_setup_t      chain = CHAIN;
    transmission_config_t config = CONFIG;
    chain.lines1 = 900.0;
    chain.ratio = 40.0;
    config.lines1 = 900u;
    config.ratio_over = 40u;
    config.ratio_under = 1u;
    config.method = TRANSMISSION_PHASE_DIGITAL;
    for (uint32_t ticks = 4000000u; ticks < 4000000u + 22222u; ticks += 53u) {
        chain_run_start(&run, &chain, &config);
        encoders_start(&encoders, &run.setup);

        add(TRANSMISSION_INPUT, ticks, 1u);

        check_found(TRANSMISSION_INPUT, 0u, 1u);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, chain_run_off(&run));
    }
}

void test_a_burst_of_extra_pulses_is_left_out(void)
{
    add(TRANSMISSION_INPUT, 4000000u, 12u);

    check_found(TRANSMISSION_INPUT, 0u, 12u);
    check_unharmed();
}

void test_extra_and_missing_pulses_of_all_methods_leave_no_step(void)
{
    static const transmission_method_t METHODS[] = {TRANSMISSION_DIRECT,
                                                    TRANSMISSION_PHASE_SUBDIVIDED};
    for (int i = 0; i < 2; ++i) {
        transmission_config_t config = CONFIG;
        config.method = METHODS[i];
        chain_run_start(&run, &CHAIN, &config);
        encoders_start(&encoders, &run.setup);
        chain_run_lines(&run, &encoders, LINES / 2.0);
        double before = chain_run_mean_off(&run);
        lose(TRANSMISSION_INPUT, encoders.next_line[0] + 5.0, 3.0);
        chain_run_look_again(&run);

        chain_run_lines(&run, &encoders, 1.5 * LINES);

        check_found(TRANSMISSION_INPUT, 3u, 0u);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, before, chain_run_mean_off(&run));
    }
}

/* Lines of the input take 1953 ticks: each pulse comes by up to 4 % of that too early or too late.
 */
void test_uneven_lines_are_not_taken_for_missing_or_extra_ones(void)
{
    dice_t           dice = dice_seed(8u);
    encoders_pulse_t pulse;
    while (encoders.next_line[1] < LINES && encoders_next(&encoders, &pulse)) {
        bool lost = pulse.channel == TRANSMISSION_INPUT && fmod(pulse.line, 100.0) == 99.0;
        if (!lost) {
            chain_run_pulse(&run, pulse.channel, pulse.ticks + dice_below(&dice, 156u));
        }
    }

    check_found(TRANSMISSION_INPUT, (uint32_t)(encoders.next_line[0] / 100.0), 0u);
    check_found(TRANSMISSION_OUTPUT, 0u, 0u);
    TEST_ASSERT_DOUBLE_WITHIN(0.08 * 31.1, 0.0, chain_run_off(&run));
}

/* ---- starting and stopping ---- */

/* Evenly faster from rest: line k is reached at sqrt(k). */
static uint32_t from_rest(double lines, double first_ticks)
{
    return (uint32_t)(first_ticks * sqrt(lines));
}

void test_shafts_that_start_from_rest_and_stop_lack_no_pulses(void)
{
    const double gate = 3600.0 / (1024.0 * 40.7); /* output lines to an input line */
    const double half = 3000.0;
    const double ticks = 2.0e5;
    double       output = 0.3;
    for (double input = 0.0; input < 2.0 * half; input += 1.0) {
        bool     stopping = input > half;
        uint32_t whole = 2u * from_rest(half, ticks);
        for (; output / gate < input; output += 1.0) {
            double at = output / gate;
            chain_run_pulse(&run, TRANSMISSION_OUTPUT,
                            at > half ? whole - from_rest(2.0 * half - at, ticks)
                                      : from_rest(at, ticks));
        }
        chain_run_pulse(&run, TRANSMISSION_INPUT,
                        stopping ? whole - from_rest(2.0 * half - input, ticks)
                                 : from_rest(input, ticks));
    }

    check_found(TRANSMISSION_OUTPUT, 0u, 0u);
    pulse_counters_t found = transmission_counters(&run.core, TRANSMISSION_INPUT);
    TEST_ASSERT_EQUAL_UINT32(0u, found.missing);
    TEST_ASSERT_EQUAL_UINT32(0u, found.extra);
}

void test_a_pause_keeps_the_count(void)
{
    chain_run_lines(&run, &encoders, LINES / 2.0);

    transmission_pause(&run.core);
    run.setup.start_ticks += 2000000000u;
    chain_run_lines(&run, &encoders, LINES);

    check_found(TRANSMISSION_INPUT, 0u, 0u);
    check_found(TRANSMISSION_OUTPUT, 0u, 0u);
    check_unharmed();
}

/* ---- the other sense ---- */

static void there_and_back(double standstill_s)
{
    run.setup.turning_turns = 5.25;
    run.setup.backlash_arcsec = 75.0;
    run.setup.standstill_s = standstill_s;
    encoders_pulse_t pulse;
    double           there = NAN;
    while (encoders_next(&encoders, &pulse)) {
        if (encoders.back && isnan(there)) {
            there = chain_run_mean_off(&run);
            TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
        }
        if (run.last.line == 440 && encoders.back) {
            chain_run_look_again(&run);
        }
        chain_run_pulse(&run, pulse.channel, pulse.ticks);
    }
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 75.0, chain_run_mean_off(&run) - there);
    TEST_ASSERT_INT32_WITHIN(2, 0, run.last.line);
}

void test_both_senses_tell_the_backlash(void)
{
    there_and_back(0.0);

    check_found(TRANSMISSION_INPUT, 0u, 0u);
    check_found(TRANSMISSION_OUTPUT, 0u, 0u);
}

void test_a_standstill_at_the_turning_point_does_no_harm(void)
{
    there_and_back(3.3);

    check_found(TRANSMISSION_INPUT, 0u, 0u);
    check_found(TRANSMISSION_OUTPUT, 0u, 0u);
}

void test_turning_back_and_forth_does_not_drift(void)
{
    double first = NAN;
    for (int cycle = 0; cycle < 50; ++cycle) {
        run.setup.turning_turns = 5.25;
        encoders_start(&encoders, &run.setup);
        encoders_pulse_t pulse;
        chain_run_look_again(&run);
        while (encoders_next(&encoders, &pulse)) {
            chain_run_pulse(&run, pulse.channel, pulse.ticks);
        }
        run.setup.start_ticks += 30000000u;
        first = isnan(first) ? chain_run_mean_off(&run) : first;
    }

    TEST_ASSERT_DOUBLE_WITHIN(0.005, first, chain_run_mean_off(&run));
    TEST_ASSERT_DOUBLE_WITHIN(WITHIN, 0.0, chain_run_off(&run));
}

/* ---- index ---- */

/* An index pulse at every `every`th line of the input, on the way there and back. */
static void play_with_index(double every)
{
    encoders_pulse_t pulse;
    run.setup.turning_turns = 5.25;
    while (encoders_next(&encoders, &pulse)) {
        bool at_index = fmod(pulse.line, every) == (encoders.back ? 1.0 : 0.0);
        chain_run_pulse(&run, pulse.channel, pulse.ticks);
        if (at_index && (pulse.channel & 127u) == TRANSMISSION_INPUT) {
            chain_run_pulse(&run, (uint8_t)(pulse.channel + 2u), pulse.ticks + 1u);
        }
    }
}

void test_index_pulses_a_turn_apart_are_good(void)
{
    play_with_index(1024.0);

    transmission_index_t index = transmission_index(&run.core, TRANSMISSION_INPUT);
    TEST_ASSERT_EQUAL_UINT32(12u, index.count);
    TEST_ASSERT_EQUAL_UINT32(0u, index.slips);
    TEST_ASSERT_EQUAL_INT32(0, index.line);
    TEST_ASSERT_EQUAL_UINT32(0u, transmission_index(&run.core, TRANSMISSION_OUTPUT).count);
}

void test_index_pulses_less_than_a_turn_apart_are_slips(void)
{
    play_with_index(1023.0);

    transmission_index_t index = transmission_index(&run.core, TRANSMISSION_INPUT);
    TEST_ASSERT_EQUAL_UINT32(12u, index.count);
    TEST_ASSERT_EQUAL_UINT32(10u, index.slips);
}

/* ---- what is no pulse ---- */

void test_a_pulse_of_no_channel_changes_nothing(void)
{
    chain_run_lines(&run, &encoders, LINES / 2.0);

    TEST_ASSERT_EQUAL_UINT8(0u, transmission_on_pulse(&run.core, 0u, 1u));
    TEST_ASSERT_EQUAL_UINT8(0u, transmission_on_pulse(&run.core, 5u, 1u));
    TEST_ASSERT_EQUAL_UINT8(0u, transmission_on_pulse(&run.core, 128u, 1u));
    chain_run_lines(&run, &encoders, LINES);

    check_unharmed();
}

/* ---- shafts that part ---- */

/*
 * The gating shaft turns and the other one all but stands: it slips, or another ratio is true.
 * Returns the last delta; none may be on the other side of 0, nor less than the one before.
 */
static int64_t part(const transmission_config_t *config, uint32_t gate_pulses, uint32_t every)
{
    static transmission_t t;
    int64_t               last = 0;
    uint32_t              ticks = 1000u;
    TEST_ASSERT_EQUAL(TRANSMISSION_OK, transmission_init(&t, config));
    uint8_t dense = transmission_dense_channel(&t);
    uint8_t gate = TRANSMISSION_INPUT + TRANSMISSION_OUTPUT - dense;
    int64_t sense = gate == TRANSMISSION_OUTPUT ? 1 : -1;
    (void)transmission_on_pulse(&t, dense, ticks);
    for (uint32_t i = 1u; i <= gate_pulses; ++i) {
        bool    is_both = i % every == 0u;
        uint8_t count = transmission_on_pulse(&t, gate, ticks += 1000u);
        for (uint8_t turn = 0u; turn <= is_both; ++turn) {
            for (uint8_t p = 0u; p < count; ++p) {
                int64_t delta = sense * transmission_point(&t, p).delta_nas;
                TEST_ASSERT_TRUE(delta >= last);
                last = delta;
            }
            count = is_both ? transmission_on_pulse(&t, dense, ticks += 10u) : 0u;
        }
    }
    return last;
}

void test_shafts_that_part_by_more_than_can_be_told_are_at_the_limit(void)
{
    static const transmission_config_t same = {
        .lines1 = 1u, .lines2 = 1u, .ratio_over = 1u, .ratio_under = 1u, .meter_ticks = 1u};
    transmission_config_t direct = {.method = TRANSMISSION_DIRECT,
                                    .lines1 = 1000u,
                                    .lines2 = 3u,
                                    .ratio_over = 1u,
                                    .ratio_under = 1u,
                                    .meter_ticks = 1u};

    TEST_ASSERT_EQUAL_INT64(INT64_MAX, part(&same, 40000u, 7000u));
    TEST_ASSERT_EQUAL_INT64(INT64_MAX, part(&direct, 60000u, 7000u));
}

/* 986,895 lines of the denser train to a line of the gate: the count of lines is full first. */
void test_shafts_that_part_by_more_lines_than_are_counted_are_at_the_limit(void)
{
    static const transmission_config_t fine = {
        .lines1 = 1u << 24, .lines2 = 17u, .ratio_over = 1u, .ratio_under = 1u, .meter_ticks = 1u};

    TEST_ASSERT_EQUAL_INT64(INT64_MAX, part(&fine, 6000u, 500u));
}

void test_after_a_restart_there_is_nothing_beyond_the_limit(void)
{
    static const transmission_config_t fine = {
        .lines1 = 1u << 24, .lines2 = 17u, .ratio_over = 1u, .ratio_under = 1u, .meter_ticks = 1u};
    transmission_t t;
    TEST_ASSERT_EQUAL(TRANSMISSION_OK, transmission_init(&t, &fine));
    t.beyond = 1;

    transmission_restart(&t);

    TEST_ASSERT_EQUAL_INT8(0, t.beyond);
}
