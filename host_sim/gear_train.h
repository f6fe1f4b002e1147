/*
 * A drive chain with two encoders, on virtual time: input shaft, up to four gear stages, a screw if
 * there is one, and the pulses that the encoders on the first and the last shaft give. It knows
 * flanks, radii and forces, and nothing of how a transmission error is measured.
 *
 * Python reads this header too: no more of the preprocessor than what can be left out.
 */
#ifndef SIM_GEAR_TRAIN_H
#define SIM_GEAR_TRAIN_H

#include <stdint.h>

#pragma GCC visibility push(default)

enum {
    SIM_GEAR_OK = 0,
    SIM_GEAR_ERR_STAGES = -1,  /* more than four, or a gear without teeth or size */
    SIM_GEAR_ERR_ENCODER = -2, /* lines, radius, jitter or clock out of range */
    SIM_GEAR_ERR_MOTION = -3,  /* speed or turns not positive, or a ripple that would stop it */
    SIM_GEAR_ERR_ERRORS = -4   /* errors so large that the output would not follow the input */
};

/* Errors of one gear, as ways along its pitch circle. */
typedef struct {
    double teeth; /* > 0; starts of a worm */
    double eccentricity_um;
    double eccentricity_phase_deg;
    double mesh_um; /* of the form of each flank: a sine a tooth */
    double mesh_phase_deg;
    double pitch_rms_um; /* of the place of a tooth; drawn for each tooth, from the seed */
} sim_gear_t;

typedef struct {
    sim_gear_t driver;
    sim_gear_t driven;
    double     module_mm; /* > 0: pitch diameter of the driven gear over its teeth */
    double     play_um;   /* between the flanks, along the pitch circle of the driven gear, >= 0 */
} sim_gear_stage_t;

typedef struct {
    double lines;           /* a turn */
    double eccentricity_um; /* of its mounting */
    double eccentricity_phase_deg;
    double radius_mm; /* of its track, > 0 */
    double jitter_ns; /* standard deviation of the time of a pulse */
    double mark;      /* width of the mark of a line, as a share of the pitch, below 1: both of its
                         edges are given. 0: its first flank alone, in both senses */
} sim_encoder_t;

typedef struct {
    sim_gear_stage_t stages[4];
    sim_encoder_t    input;
    sim_encoder_t    output;
    double           screw_lead_mm;  /* 0: the output is a shaft */
    double           screw_error_um; /* of the thread, a sine a turn */
    double           screw_error_phase_deg;
    double           screw_lead_error_ppm;
    double           stiffness_nm_per_rad; /* of the train seen from its output; 0: rigid */
    double           load_nm;              /* torque at the output, against the motion */
    double           load_ripple_nm;
    double           load_ripple_order; /* a turn of the output */
    double           speed_rev_s;       /* of the input */
    double           speed_ripple;      /* share of the speed, 0 to 0.9 */
    double           speed_ripple_hz;
    double           turns;    /* of the input, in each sense */
    double           clock_hz; /* of the capture unit; times are cut to its ticks */
    uint64_t         seed;
    int32_t          stage_count; /* 0 to 4 */
    int32_t          both_senses; /* 1: turn back afterwards */
} sim_gear_train_t;

/* A pulse that is next on one of the encoders. */
typedef struct {
    double  t_ns;
    int64_t flank; /* the first of line n is 2n, the second 2n + 1 */
} sim_gear_pulse_t;

/* A run in progress, owned by the caller; the fields are the simulator's. */
typedef struct {
    sim_gear_train_t train;
    sim_gear_pulse_t next[2]; /* input, output */
    double           last_ns;
    double           ratio;      /* nominal turns of the input in a turn of the output */
    double           play_turns; /* of all stages, at the input */
    double           one_way_s;
    int32_t          sense;
} sim_gear_run_t;

/* Start at rest, flanks in contact. SIM_GEAR_OK or a negative code. */
int sim_gear_start(sim_gear_run_t *run, const sim_gear_train_t *train);

/*
 * Write up to `n` pulses in order of time: channel 1 of the input, 2 of the output, plus 128 when
 * turning back, plus 64 where the edge falls: the second flank forward, the first one backward.
 * Returns how many; fewer than n when the way is done.
 */
uint64_t sim_gear_pulses(sim_gear_run_t *run, uint64_t n, uint8_t *channels, int64_t *t_ns);

/* A sentence for a code of sim_gear_start(). */
const char *sim_gear_error(int code);

#pragma GCC visibility pop

#endif
