#include "chain_run.h"

#include <math.h>

#include "unity.h"

void chain_run_start(chain_run_t *run, const encoders_setup_t *setup,
                     const transmission_config_t *config)
{
    *run = (chain_run_t){.setup = *setup};
    TEST_ASSERT_EQUAL(TRANSMISSION_OK, transmission_init(&run->core, config));
    chain_run_look_again(run);
}

void chain_run_look_again(chain_run_t *run)
{
    run->points = 0.0;
    run->sum_off = 0.0;
    run->lowest = run->lowest_off = INFINITY;
    run->highest = run->highest_off = -INFINITY;
}

static void look_at(chain_run_t *run, transmission_point_t point)
{
    double measured = (double)point.delta_nas * ARCSEC_PER_NAS;
    double off = measured - encoders_error_arcsec(&run->setup, point.line);
    run->last = point;
    run->points += 1.0;
    run->sum_off += off;
    run->lowest = fmin(run->lowest, measured);
    run->highest = fmax(run->highest, measured);
    run->lowest_off = fmin(run->lowest_off, off);
    run->highest_off = fmax(run->highest_off, off);
}

void chain_run_pulse(chain_run_t *run, uint8_t channel, uint32_t ticks)
{
    uint8_t found = transmission_on_pulse(&run->core, channel, ticks);
    for (uint8_t i = 0u; i < found; ++i) {
        look_at(run, transmission_point(&run->core, i));
    }
}

void chain_run_lines(chain_run_t *run, encoders_t *encoders, double lines)
{
    encoders_pulse_t pulse;
    while (encoders->next_line[1] < lines && encoders_next(encoders, &pulse)) {
        chain_run_pulse(run, pulse.channel, pulse.ticks);
    }
}

double chain_run_mean_off(const chain_run_t *run)
{
    return run->sum_off / run->points;
}

double chain_run_off(const chain_run_t *run)
{
    return 0.5 * (run->highest_off - run->lowest_off);
}
