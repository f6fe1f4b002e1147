/*
 * Transmission error of a drive chain from the pulses of two encoders: delta = theta2 - theta1/i,
 * an angle at the output shaft, by five methods. One pulse at a time, in integers: nothing drifts,
 * because the ratio is kept as a fraction and the count as a whole number and a remainder.
 *
 * The rarer of the two trains gates the measurement and the denser one is subdivided. Pulses that
 * are missing or too many are found by comp/pulse_judge, counted, and put right.
 * Python reads this header too: no more of the preprocessor than what can be left out.
 */
#ifndef COMP_TRANSMISSION_H
#define COMP_TRANSMISSION_H

#include <stdbool.h>
#include <stdint.h>

#include "comp/phase_meter.h"
#include "comp/pulse_judge.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    TRANSMISSION_INPUT = 1,
    TRANSMISSION_OUTPUT = 2,
    TRANSMISSION_INPUT_INDEX = 3,
    TRANSMISSION_OUTPUT_INDEX = 4,
    TRANSMISSION_BACKWARD = 128, /* added to a channel: the shaft turns backward */
    TRANSMISSION_PENDING = 8     /* gate pulses between two pulses of the denser train */
};

typedef enum {
    TRANSMISSION_OK = 0,
    TRANSMISSION_ERR_LINES = -1,  /* not 1 … 2^24 */
    TRANSMISSION_ERR_RATIO = -2,  /* zero above or below the bar */
    TRANSMISSION_ERR_RANGE = -3,  /* the fraction i*lines1/lines2 does not fit into 31 bits, one
                                     train has a million times the pulses of the other, or a line
                                     is less than 0.001" */
    TRANSMISSION_ERR_METHOD = -4, /* none of transmission_method_t */
    TRANSMISSION_ERR_METER = -5   /* a time constant of 0, or a range that is too large */
} transmission_error_t;

typedef enum {
    TRANSMISSION_SUBDIVIDED,       /* counts, and the clock subdivides the denser train's line */
    TRANSMISSION_DIRECT,           /* counts whole lines: errs by up to half a line */
    TRANSMISSION_PHASE_SUBDIVIDED, /* phase in the line by the clock; whole lines by continuity:
                                      it may change by less than half a line from point to point */
    TRANSMISSION_PHASE_DIGITAL,    /* both trains divided to one frequency, the clock counts the
                                      lag and the period before; one point a period, range one
                                      period */
    TRANSMISSION_PHASE_ANALOG      /* the same, by a flip-flop and a low-pass meter */
} transmission_method_t;

/*
 * With `range` both dividers divide so many times further, for so many times the range. 0 is just
 * enough for four lines of the denser train: the lag of any two trains then begins away from the
 * ends.
 */
typedef struct {
    transmission_method_t method;
    uint32_t              lines1;      /* of the input encoder, a turn */
    uint32_t              lines2;      /* of the output encoder, a turn */
    uint32_t              ratio_over;  /* i = input turns in an output turn, as a fraction */
    uint32_t              ratio_under; /* 407/10: over 407, under 10 */
    uint32_t              range;       /* of digital and analog phase comparison; see above */
    uint32_t              meter_ticks; /* time constant of the analog meter; 1 or more */
} transmission_config_t;

typedef struct {
    int64_t delta_nas; /* nanoarcseconds at the output; its zero is where counting began. INT64_MAX
                          or -INT64_MAX: beyond what can be told, see below */
    int32_t  line;     /* of the gating train: 0 is its first pulse after the denser one's */
    uint32_t ticks;    /* when that line passed */
} transmission_point_t;

/*
 * Shafts may part by 7115 turns of the output or 2^30 lines of the denser train, whichever is less.
 * Beyond that, as where a belt slips or the ratio is another one, delta is at its limit. Past the
 * lines it stays there until transmission_restart().
 */

/* Index pulses of one shaft. */
typedef struct {
    uint32_t count;
    uint32_t slips; /* not a whole number of turns after the one before */
    int32_t  line;  /* the line of its train that had passed at the last one */
} transmission_index_t;

/* Owned by the caller; the fields are for these modules. One context only. */
typedef struct {
    /* set once */
    uint64_t              under_inverse; /* 2^64 / step_under */
    int64_t               line_nas;      /* a line of the denser train, at the output */
    transmission_config_t config;
    uint32_t              step_lines; /* denser train's lines in a gate line: step_lines + ... */
    uint32_t              step_over;  /* ... step_over / step_under */
    uint32_t              step_under;
    int32_t               lines_most; /* of a difference that delta_nas can tell */
    uint32_t              judge_line; /* a gate line in the unit in which its train is judged */
    /* where the trains are */
    uint32_t             remainder;     /* gate minus denser train, in the latter's lines: ... */
    int32_t              lines;         /* ... lines + remainder / step_under */
    int64_t              reference_q32; /* the same with its fraction, at the last point */
    int64_t              expected_q32;  /* and at the point before: what was expected of it */
    int64_t              unwrapped_q32; /* phase comparison: turns of phase since the first point */
    uint32_t             phase_q32;
    uint32_t             expected_ticks; /* when the denser train's last good pulse was due */
    pulse_train_t        gate;
    pulse_train_t        dense;
    phase_meter_t        meter;
    transmission_index_t index[2]; /* input, output */
    /* points */
    transmission_point_t held; /* until the next gate pulse shows that it was none too many */
    transmission_point_t ready[TRANSMISSION_PENDING];
    uint32_t             pending_ticks[TRANSMISSION_PENDING];
    int8_t               pending_sense[TRANSMISSION_PENDING];
    uint8_t              pending;
    uint8_t              ready_count;
    uint8_t              judge_shift;
    int8_t               beyond; /* the side on which more lines were than are counted, or 0 */
    bool                 gate_is_output;
    bool                 has_reference;
    bool                 rested; /* since the last pulse of the denser train */
    bool                 has_held;
    bool                 held_is_fresh; /* from the last interval of the denser train */
} transmission_t;

/* Before first use. TRANSMISSION_OK or a negative code, and then *t is not to be used. Task. */
int transmission_init(transmission_t *t, const transmission_config_t *config);

/*
 * A pulse of `channel` at `ticks`, in order of time; a wrapping counter will do, as long as the
 * denser train does not rest for 2^31 ticks without transmission_pause(). Returns how many points
 * there are now, and they stay until the next pulse; a point comes out when the next gate pulse has
 * shown that it was none too many. Any other channel is taken for no pulse. Task or ISR, one of
 * them.
 */
uint8_t transmission_on_pulse(transmission_t *t, uint8_t channel, uint32_t ticks);

/* Point `i` of those that the last pulse has brought. */
transmission_point_t transmission_point(const transmission_t *t, uint8_t i);

/*
 * The shafts have rested, or time has jumped: what comes next is not compared in time with what
 * was. Counts go on.
 */
void transmission_pause(transmission_t *t);

/*
 * Begin anew where nobody knows how far the shafts have turned: lines and delta count from 0 again,
 * what was found in the trains goes on.
 */
void transmission_restart(transmission_t *t);

/* The denser train: TRANSMISSION_INPUT or TRANSMISSION_OUTPUT. */
uint8_t transmission_dense_channel(const transmission_t *t);

/* What was found in the train of TRANSMISSION_INPUT or TRANSMISSION_OUTPUT. */
pulse_counters_t transmission_counters(const transmission_t *t, uint8_t channel);

/* What is known of the index of TRANSMISSION_INPUT or TRANSMISSION_OUTPUT. */
transmission_index_t transmission_index(const transmission_t *t, uint8_t channel);

#ifdef __cplusplus
}
#endif

#endif
