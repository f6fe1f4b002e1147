#include "gear_train.h"

#include <math.h>
#include <stdbool.h>

#include "angle.h"
#include "random.h"

#define UM_PER_MM   1000.0
#define NS_PER_S    1e9
#define PPM         1e-6
#define BACKWARD    128u
#define FALLING     64u
#define INPUT       0
#define OUTPUT      1
#define MOST_STAGES 4
#define ROUNDS      60
#define CLOSE       4e-16 /* of a position, and of a turn */
#define STEEPEST    0.3   /* errors may change by that share of the way, or nothing converges */
#define LANE_JITTER 0u
#define LANE_PITCH  1u
#define PAUSE_S     0.1 /* standing before it turns back */

/* Whole turns are left out first: thousands of them would cost digits. */
static double sine(double turns, double phase_deg)
{
    return sim_wave(turns - floor(turns), phase_deg);
}

/* ---- gears: ways along the pitch circle ------------------------------------------------------ */

static double drawn_pitch_um(const sim_gear_t *gear, uint64_t seed, uint32_t serial, double tooth)
{
    sim_random_t random;
    double       on_gear = tooth - floor(tooth / gear->teeth) * gear->teeth;
    sim_random_begin(&random, seed, serial, (uint64_t)on_gear, LANE_PITCH);
    return sim_random_normal(&random, gear->pitch_rms_um);
}

/* One tooth hands over to the next smoothly: two share the load for a while. */
static double pitch_um(const sim_gear_t *gear, uint64_t seed, uint32_t serial, double turns)
{
    if (gear->pitch_rms_um <= 0.0) {
        return 0.0;
    }
    double place = turns * gear->teeth;
    double tooth = floor(place);
    double share = 0.5 - 0.5 * cos(PI * (place - tooth));
    return (1.0 - share) * drawn_pitch_um(gear, seed, serial, tooth) +
           share * drawn_pitch_um(gear, seed, serial, tooth + 1.0);
}

/* By how far the flank in contact is ahead of that of a perfect gear. */
static double flank_um(const sim_gear_t *gear, uint64_t seed, uint32_t serial, double turns)
{
    return gear->eccentricity_um * sine(turns, gear->eccentricity_phase_deg) +
           gear->mesh_um * sine(turns * gear->teeth, gear->mesh_phase_deg) +
           pitch_um(gear, seed, serial, turns);
}

static double circumference_um(const sim_gear_stage_t *stage, const sim_gear_t *gear)
{
    return PI * stage->module_mm * UM_PER_MM * gear->teeth;
}

/* The flanks touch: the way of the driver's is that of the driven one's. */
static double driven_turns(const sim_gear_stage_t *stage, uint64_t seed, uint32_t serial,
                           double driver_turns)
{
    double way_um = driver_turns * circumference_um(stage, &stage->driver) +
                    flank_um(&stage->driver, seed, serial, driver_turns);
    double around_um = circumference_um(stage, &stage->driven);
    double turns = way_um / around_um;
    for (int round = 0; round < ROUNDS; ++round) {
        double before = turns;
        turns = (way_um - flank_um(&stage->driven, seed, serial + 1u, turns)) / around_um;
        if (fabs(turns - before) <= CLOSE * (1.0 + fabs(turns))) {
            break;
        }
    }
    return turns;
}

/* ---- the train ------------------------------------------------------------------------------- */

static double twisted(const sim_gear_run_t *run, double turns)
{
    const sim_gear_train_t *train = &run->train;
    if (train->stiffness_nm_per_rad <= 0.0) {
        return turns;
    }
    double ripple_nm = train->load_ripple_nm * sine(turns * train->load_ripple_order, 0.0);
    double twist_rad = (train->load_nm * run->sense + ripple_nm) / train->stiffness_nm_per_rad;
    return turns - twist_rad / (2.0 * PI);
}

/* Travel of the nut in leads, which a scale measures. */
static double screwed(const sim_gear_train_t *train, double turns)
{
    if (train->screw_lead_mm <= 0.0) {
        return turns;
    }
    double thread_um = train->screw_error_um * sine(turns, train->screw_error_phase_deg);
    return turns * (1.0 + train->screw_lead_error_ppm * PPM) +
           thread_um / (train->screw_lead_mm * UM_PER_MM);
}

static double output_turns(const sim_gear_run_t *run, double driving_turns)
{
    const sim_gear_train_t *train = &run->train;
    double                  turns = driving_turns;
    for (int32_t i = 0; i < train->stage_count; ++i) {
        turns = driven_turns(&train->stages[i], train->seed, 2u * (uint32_t)i, turns);
    }
    return screwed(train, twisted(run, turns));
}

static double read_turns(const sim_encoder_t *encoder, double turns)
{
    double off_um = encoder->eccentricity_um * sine(turns, encoder->eccentricity_phase_deg);
    return turns + off_um / (2.0 * PI * encoder->radius_mm * UM_PER_MM);
}

/* ---- when a line passes ---------------------------------------------------------------------- */

static const sim_encoder_t *encoder_of(const sim_gear_run_t *run, int channel)
{
    return channel == INPUT ? &run->train.input : &run->train.output;
}

static double read_at(const sim_gear_run_t *run, int channel, double driving_turns)
{
    double shaft = channel == INPUT ? driving_turns : output_turns(run, driving_turns);
    return read_turns(encoder_of(run, channel), shaft);
}

/* Where the driving flank stands, in turns of the input, when an encoder reads `read`. */
static double driving_at(const sim_gear_run_t *run, int channel, double read)
{
    double ratio = channel == INPUT ? 1.0 : run->ratio;
    double turns = read * ratio;
    for (int round = 0; round < ROUNDS; ++round) {
        double step = ratio * (read - read_at(run, channel, turns));
        turns += step;
        if (fabs(step) <= CLOSE * (ratio + fabs(turns))) {
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
    for (int round = 0; round < ROUNDS && high - low > CLOSE * latest; ++round) {
        double ahead = time + swing * (1.0 - cos(pulse * time)) - latest;
        *(ahead > 0.0 ? &high : &low) = time;
        double next = time - ahead / (1.0 + train->speed_ripple * sin(pulse * time));
        if (fabs(next - time) <= CLOSE * latest) {
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
    sim_random_begin(&random, run->train.seed, serial, (uint64_t)line_of(flank), LANE_JITTER);
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

static bool in_range(double value, double low, double high)
{
    return value >= low && value <= high; /* false for NaN */
}

static bool is_gear(const sim_gear_stage_t *stage, const sim_gear_t *gear)
{
    return in_range(gear->teeth, 1.0, 1e4) && in_range(stage->module_mm, 1e-3, 1e3);
}

static bool follows(const sim_gear_stage_t *stage, const sim_gear_t *gear)
{
    double steep_um = 2.0 * PI * (fabs(gear->eccentricity_um) + gear->teeth * fabs(gear->mesh_um)) +
                      8.0 * PI * gear->teeth * fabs(gear->pitch_rms_um);
    return steep_um <= STEEPEST * circumference_um(stage, gear);
}

static int check_stages(const sim_gear_train_t *train)
{
    if (train->stage_count < 0 || train->stage_count > MOST_STAGES) {
        return SIM_GEAR_ERR_STAGES;
    }
    for (int32_t i = 0; i < train->stage_count; ++i) {
        const sim_gear_stage_t *stage = &train->stages[i];
        if (!is_gear(stage, &stage->driver) || !is_gear(stage, &stage->driven) ||
            !in_range(stage->play_um, 0.0, 1e6)) {
            return SIM_GEAR_ERR_STAGES;
        }
        if (!follows(stage, &stage->driver) || !follows(stage, &stage->driven)) {
            return SIM_GEAR_ERR_ERRORS;
        }
    }
    return SIM_GEAR_OK;
}

static bool is_encoder(const sim_encoder_t *encoder)
{
    return in_range(encoder->lines, 1.0, 1e7) && in_range(encoder->radius_mm, 0.1, 1e5) &&
           in_range(encoder->jitter_ns, 0.0, 1e9) && in_range(encoder->mark, 0.0, 0.999) &&
           fabs(encoder->eccentricity_um) <= STEEPEST * encoder->radius_mm * UM_PER_MM;
}

static bool is_motion(const sim_gear_train_t *train)
{
    return in_range(train->speed_rev_s, 1e-6, 1e6) && in_range(train->turns, 1e-6, 1e9) &&
           in_range(train->speed_ripple, 0.0, 0.9) &&
           (train->speed_ripple <= 0.0 || in_range(train->speed_ripple_hz, 1e-6, 1e6));
}

static bool follows_load(const sim_gear_train_t *train)
{
    double steep = fabs(train->load_ripple_nm * train->load_ripple_order);
    double thread_um = 2.0 * PI * fabs(train->screw_error_um);
    return (train->stiffness_nm_per_rad <= 0.0 ||
            steep <= STEEPEST * train->stiffness_nm_per_rad) &&
           (train->screw_lead_mm <= 0.0 ||
            thread_um <= STEEPEST * train->screw_lead_mm * UM_PER_MM) &&
           fabs(train->screw_lead_error_ppm * PPM) <= STEEPEST;
}

static void set_ratio(sim_gear_run_t *run)
{
    run->ratio = 1.0;
    run->play_turns = 0.0;
    for (int32_t i = 0; i < run->train.stage_count; ++i) {
        const sim_gear_stage_t *stage = &run->train.stages[i];
        run->ratio *= stage->driven.teeth / stage->driver.teeth;
        run->play_turns += run->ratio * stage->play_um / circumference_um(stage, &stage->driven);
    }
}

int sim_gear_start(sim_gear_run_t *run, const sim_gear_train_t *train)
{
    int code = check_stages(train);
    if (code != SIM_GEAR_OK) {
        return code;
    }
    if (!is_encoder(&train->input) || !is_encoder(&train->output) ||
        !in_range(train->clock_hz, 1.0, 1e10)) {
        return SIM_GEAR_ERR_ENCODER;
    }
    if (!is_motion(train)) {
        return SIM_GEAR_ERR_MOTION;
    }
    if (!follows_load(train)) {
        return SIM_GEAR_ERR_ERRORS;
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

const char *sim_gear_error(int code)
{
    switch (code) {
    case SIM_GEAR_OK:
        return "no error";
    case SIM_GEAR_ERR_STAGES:
        return "gears: expected up to 4 stages, teeth from 1 and a module above 0";
    case SIM_GEAR_ERR_ENCODER:
        return "encoder: expected lines from 1, a radius above its eccentricity, marks below 1, "
               "a clock";
    case SIM_GEAR_ERR_MOTION:
        return "motion: expected speed and turns above 0, and a ripple of at most 0.9";
    default:
        return "errors so large that the output would not follow the input";
    }
}
