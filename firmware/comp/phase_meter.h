/*
 * Two trains divided down to the same frequency, a flip-flop that one sets and the other resets,
 * and what reads it: a counter (digital phase comparison) or a low-pass meter (analog).
 */
#ifndef COMP_PHASE_METER_H
#define COMP_PHASE_METER_H

#include <stdbool.h>
#include <stdint.h>

/* Fields are for firmware/comp. */
typedef struct {
    uint32_t dense_divider; /* lines of each train in a period */
    uint32_t gate_divider;
    uint32_t time_constant_ticks;
    uint32_t dense_left; /* lines until the divided pulse */
    uint32_t gate_left;
    uint32_t set_ticks;    /* last divided pulse of the denser train */
    uint32_t period_ticks; /* between the last two; 0: not known yet */
    uint32_t needle_q31;   /* 0 … 2^31 */
    uint32_t needle_ticks; /* when it stood there */
    uint64_t warm_ticks;   /* since it was switched on */
    bool     has_begun;
    bool     has_set;
    bool     is_set; /* the flip-flop */
} phase_meter_t;

/* Dividers and time constant ≥ 1. The lag begins in the middle of its range. */
void phase_meter_init(phase_meter_t *m, uint32_t dense_divider, uint32_t gate_divider,
                      uint32_t time_constant_ticks);

/* `lines` lines of the denser train have passed, evenly, in `interval_ticks` until `ticks`. */
void phase_meter_on_dense(phase_meter_t *m, uint32_t lines, uint32_t ticks,
                          uint32_t interval_ticks);

/* `lines` lines of the gating train have passed at `ticks`. True at a divided pulse. */
bool phase_meter_on_gate(phase_meter_t *m, uint32_t lines, uint32_t ticks);

/*
 * At a divided pulse of the gate, at `ticks`: its lag over the period before, in 2^-32 of a period
 * and without whole periods. False before there was a period.
 */
bool phase_meter_digital(const phase_meter_t *m, uint32_t ticks, uint32_t *lag_q32);

/* The needle's reading of the same; false until eight time constants have passed. */
bool phase_meter_analog(const phase_meter_t *m, uint32_t *lag_q32);

#endif
