/*
 * The pulses of two encoders on a drive chain that turns, worked out in floating point from when
 * the shafts are where; knows nothing of how they are measured.
 */
#ifndef ENCODERS_H
#define ENCODERS_H

#include <stdbool.h>
#include <stdint.h>

#define ENCODERS_ARCSEC_PER_TURN 1296000.0

/* Angles are in turns of the shaft they belong to. */
typedef struct {
    double   lines1;
    double   lines2;
    double   ratio; /* input turns in an output turn */
    double   input_rev_per_s;
    double   error_arcsec;    /* amplitude of the planted error, once in an output turn */
    double   ripple;          /* of the speed, once in an input turn: part of the mean */
    double   backlash_arcsec; /* how far the output stays behind on the way back */
    double   phase;           /* of a line: where the output's first line lies */
    double   tick_s;
    double   turning_turns; /* input angle at which the shafts turn back; 0: never */
    double   standstill_s;  /* there */
    uint32_t start_ticks;   /* reading of the clock at the beginning */
} encoders_setup_t;

typedef struct {
    uint8_t  channel; /* 1 input, 2 output; + 128 on the way back */
    uint32_t ticks;
    double   time_s;
    double   line; /* of its own encoder */
} encoders_pulse_t;

typedef struct {
    const encoders_setup_t *setup;
    bool                    back;
    double                  next_line[2];
} encoders_t;

void encoders_start(encoders_t *e, const encoders_setup_t *setup);

/* The next pulse in order of time. On the way back it ends with line 0: then false. */
bool encoders_next(encoders_t *e, encoders_pulse_t *pulse);

/* The planted error at the output's line `line`. */
double encoders_error_arcsec(const encoders_setup_t *setup, double line);

#endif
