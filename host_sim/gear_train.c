#include "gear_train.h"

#include <math.h>
#include <stdbool.h>

#include "angle.h"
#include "gear_check.h"
#include "gear_output.h"
#include "random.h"

#define NS_PER_S 1e9
#define BACKWARD 128u
#define FALLING  64u
#define INPUT    0
#define OUTPUT   1
#define PAUSE_S  0.1 /* standing before it turns back */

/* ---- when a line passes ---------------------------------------------------------------------- */

static double read_turns(const sim_encoder_t *encoder, double turns)
{
    double off_um =
        encoder->eccentricity_um * sim_gear_sine(turns, encoder->eccentricity_phase_deg);
    return turns + off_um / (2.0 * PI * encoder->radius_mm * GEAR_UM_PER_MM);
}

static const sim_encoder_t *encoder_of(const sim_gear_run_t *run, int channel)
{
    return channel == INPUT ? &run->train.input : &run->train.output;
}

static double read_at(const sim_gear_run_t *run, int channel, double driving_turns)
{
    double shaft = channel == INPUT ? driving_turns : sim_gear_output_turns(run, driving_turns);
    return read_turns(encoder_of(run, channel), shaft);
}

/* Where the driving flank stands, in turns of the input, when an encoder reads `read`. */
static double driving_at(const sim_gear_run_t *run, int channel, double read)
{
    double ratio = channel == INPUT ? 1.0 : run->ratio;
    double turns = read * ratio;
    for (int round = 0; round < GEAR_ROUNDS; ++round) {
        double step = ratio * (read - read_at(run, channel, turns));
        turns += step;
        if (fabs(step) <= GEAR_CLOSE * (ratio + fabs(turns))) {
            break;
        }
    }
    return turns;
}

/* Since the start of a way of so many turns; the ripple starts with it. */
static double moving_s(const sim_gear_train_t *train, double way_turns)
{
    double latest = way_turns / train->speed_rev_s;
    if (train->speed_ripple <= 0.0) {
        return latest;
    }
    double pulse = 2.0 * PI * train->speed_ripple_hz;
    double swing = train->speed_ripple / pulse;
    double low = fmax(latest - 2.0 * swing, 0.0);
    double high = latest;
    double time = 0.5 * (low + high);
    for (int round = 0; round < GEAR_ROUNDS && high - low > GEAR_CLOSE * latest; ++round) {
        double ahead = time + swing * (1.0 - cos(pulse * time)) - latest;
        *(ahead > 0.0 ? &high : &low) = time;
        double next = time - ahead / (1.0 + train->speed_ripple * sin(pulse * time));
        if (fabs(next - time) <= GEAR_CLOSE * latest) {
            break;
        }
        time = next > low && next < high ? next : 0.5 * (low + high);
    }
    return time;
}

static bool is_second(int64_t flank)
{
    return ((uint64_t)flank & 1u) != 0u;
}

static int64_t line_of(int64_t flank)
{
    return (flank - is_second(flank)) / 2;
}

static double jitter_ns(const sim_gear_run_t *run, int channel, int64_t flank)
{
    double sigma = encoder_of(run, channel)->jitter_ns;
    if (sigma <= 0.0) {
        return 0.0;
    }
    sim_random_t random;
    uint64_t serial = (uint64_t)channel + (run->sense < 0 ? 2u : 0u) + (is_second(flank) ? 4u : 0u);
    sim_random_begin(&random, run->train.seed, serial, (uint64_t)line_of(flank), GEAR_LANE_JITTER);
    return sim_random_normal(&random, sigma);
}

/* Reading of an encoder at a flank. */
static double flank_turns(const sim_encoder_t *encoder, int64_t flank)
{
    return ((double)line_of(flank) + (is_second(flank) ? encoder->mark : 0.0)) / encoder->lines;
}

static int64_t flank_step(const sim_encoder_t *encoder)
{
    return encoder->mark > 0.0 ? 1 : 2;
}

/* Set when the pulse that is next on a channel comes. */
static void foresee(sim_gear_run_t *run, int channel)
{
    const sim_gear_train_t *train = &run->train;
    sim_gear_pulse_t       *next = &run->next[channel];

    double turns = driving_at(run, channel, flank_turns(encoder_of(run, channel), next->flank));
    double at_s = 0.0;
    if (run->sense > 0) {
        at_s = moving_s(train, turns);
    } else {
        /* The input is behind the flank that now drives the output by all play. */
        double input = channel == INPUT ? turns : turns - run->play_turns;
        at_s = run->one_way_s + PAUSE_S + moving_s(train, train->turns - input);
    }
    next->t_ns = at_s * NS_PER_S + jitter_ns(run, channel, next->flank);
}

static void turn_back(sim_gear_run_t *run)
{
    run->sense = -1;
    for (int channel = INPUT; channel <= OUTPUT; ++channel) {
        run->next[channel].flank -= flank_step(encoder_of(run, channel));
        foresee(run, channel);
    }
}

static bool is_beyond(const sim_gear_run_t *run)
{
    double first_ns = fmin(run->next[INPUT].t_ns, run->next[OUTPUT].t_ns);
    double all_s = run->sense > 0 ? run->one_way_s : 2.0 * run->one_way_s + PAUSE_S;
    return first_ns > all_s * NS_PER_S;
}

/* ---- what is called from outside ------------------------------------------------------------- */

static void set_ratio(sim_gear_run_t *run)
{
    run->ratio = 1.0;
    run->play_turns = 0.0;
    for (int32_t i = 0; i < run->train.stage_count; ++i) {
        const sim_gear_stage_t *stage = &run->train.stages[i];
        run->ratio *= stage->driven.teeth / stage->driver.teeth;
        run->play_turns +=
            run->ratio * stage->play_um / sim_gear_circumference_um(stage, &stage->driven);
    }
}

int sim_gear_start(sim_gear_run_t *run, const sim_gear_train_t *train)
{
    int code = sim_gear_check(train);
    if (code != SIM_GEAR_OK) {
        return code;
    }
    *run = (sim_gear_run_t){.train = *train, .sense = 1};
    set_ratio(run);
    run->one_way_s = moving_s(train, train->turns);
    for (int channel = INPUT; channel <= OUTPUT; ++channel) {
        double lines = encoder_of(run, channel)->lines;
        run->next[channel].flank = 2 * ((int64_t)floor(read_at(run, channel, 0.0) * lines) + 1);
        foresee(run, channel);
    }
    return SIM_GEAR_OK;
}

/* The capture unit stamps in order, and in its ticks. */
static int64_t stamped_ns(sim_gear_run_t *run, double t_ns)
{
    run->last_ns = fmax(run->last_ns, t_ns);
    double ticks = floor(run->last_ns * (run->train.clock_hz / NS_PER_S));
    return (int64_t)rint(ticks * (NS_PER_S / run->train.clock_hz));
}

/* With a mark its first flank rises forward and falls backward; without one all is a pulse. */
static uint8_t code_of(const sim_gear_run_t *run, int channel)
{
    bool is_backward = run->sense < 0;
    bool falls =
        encoder_of(run, channel)->mark > 0.0 && is_second(run->next[channel].flank) != is_backward;
    return (uint8_t)(channel + 1 + (is_backward ? (int)BACKWARD : 0) + (falls ? (int)FALLING : 0));
}

uint64_t sim_gear_pulses(sim_gear_run_t *run, uint64_t n, uint8_t *channels, int64_t *t_ns)
{
    for (uint64_t written = 0; written < n; ++written) {
        if (is_beyond(run) && run->sense > 0 && run->train.both_senses != 0) {
            turn_back(run);
        }
        if (is_beyond(run)) {
            return written;
        }
        int channel = run->next[OUTPUT].t_ns < run->next[INPUT].t_ns ? OUTPUT : INPUT;
        channels[written] = code_of(run, channel);
        t_ns[written] = stamped_ns(run, run->next[channel].t_ns);
        run->next[channel].flank += run->sense * flank_step(encoder_of(run, channel));
        foresee(run, channel);
    }
    return n;
}
