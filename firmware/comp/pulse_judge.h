/*
 * Tells missing and extra pulses of a train of lines from what is normal: each pulse has advanced
 * by about a line, measured in time (then a line is the interval before) or by another train.
 */
#ifndef COMP_PULSE_JUDGE_H
#define COMP_PULSE_JUDGE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PULSE_MISSING_MAX = 32,  /* more at once are not believed: the shaft may have rested */
    PULSE_REJECTED_MAX = 16, /* more in a row are not believed: the shaft runs faster */
    PULSE_STEADY = 4         /* even intervals in a row after which time is believed */
};

typedef struct {
    uint32_t pulses;  /* as they came, good or bad */
    uint32_t missing; /* lines without a pulse, added to the count */
    uint32_t extra;   /* pulses without a line, left out of the count */
    uint32_t slips;   /* advances that fit no whole number of lines: taken as they came */
} pulse_counters_t;

/* One train. Fields are for firmware/comp. */
typedef struct {
    pulse_counters_t counters;
    int32_t          line;         /* of the last good pulse, from 0 */
    uint32_t         ticks;        /* of that pulse */
    uint32_t         period_ticks; /* of the last line */
    uint32_t         mean_q4;      /* of the last few, in 2^-4 ticks */
    uint32_t         doubtful;     /* advance of a pulse that may be a line, until the next; or 0 */
    int8_t           sense;        /* +1, -1; 0 before the first pulse */
    uint8_t          steady;
    uint8_t          rejected; /* in a row */
} pulse_train_t;

/*
 * How many lines a pulse stands for that has come `advance` after the last good one, in units of
 * which `line` (≥ 1) make a line: 1, more after missing ones, 0 for an extra one. Counts them. One
 * that comes between two lines is in doubt, and 0, until the next one shows whether it was extra.
 */
uint8_t pulse_judge(pulse_train_t *train, uint32_t advance, uint32_t line);

/*
 * The same by time alone; learns how long a line takes. Everything is good until it runs evenly,
 * and where a line takes 2^28 ticks or more.
 */
uint8_t pulse_judge_ticks(pulse_train_t *train, uint32_t interval_ticks);

/* Forget how long a line takes. */
void pulse_judge_forget(pulse_train_t *train);

#ifdef __cplusplus
}
#endif

#endif
