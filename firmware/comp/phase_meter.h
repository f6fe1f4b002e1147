/*
 * Two trains divided down to the same frequency, a flip-flop that one sets and the other resets,
 * and what reads it: a counter (digital phase comparison) or a low-pass meter (analog).
 */
#ifndef COMP_PHASE_METER_H
#define COMP_PHASE_METER_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Fields are for firmware/comp. */
typedef struct {
    uint64_t now_ticks;    /* at the denser train's last pulse, since it began */
    uint64_t set_ticks;    /* at its last divided pulse */
    uint64_t period_ticks; /* between the last two of those; 0: not known yet */
    uint64_t needle_ticks; /* up to where the needle has moved */
    uint64_t warm_ticks;   /* when it was switched on */
    uint32_t needle_q31;   /* 0 … 2^31 */
    uint32_t time_constant_ticks;
    uint32_t dense_divider; /* lines of each train in a period */
    uint32_t gate_divider;
    uint32_t dense_left; /* lines until the divided pulse */
    uint32_t gate_left;
    bool     has_begun;
    bool     has_set;
    bool     is_set; /* the flip-flop */
} phase_meter_t;

/* Dividers and time constant ≥ 1. The lag begins in the middle of its range. */
void phase_meter_init(phase_meter_t *m, uint32_t dense_divider, uint32_t gate_divider,
                      uint32_t time_constant_ticks);

/* `lines` lines of the denser train have passed, evenly, in the last `interval_ticks`. */
void phase_meter_on_dense(phase_meter_t *m, uint32_t lines, uint32_t interval_ticks);

/* The denser train's last pulse was `shift_ticks` later than it was said to be. */
void phase_meter_mend_dense(phase_meter_t *m, uint32_t shift_ticks);

/*
 * `lines` lines of the gating train have passed, `since_ticks` after the denser train's last
 * pulse. True at a divided pulse.
 */
bool phase_meter_on_gate(phase_meter_t *m, uint32_t lines, int32_t since_ticks);

/*
 * At a divided pulse of the gate: its lag over the period before, in 2^-32 of a period and without
 * whole periods. False before there was a period.
 */
bool phase_meter_digital(const phase_meter_t *m, int32_t since_ticks, uint32_t *lag_q32);

/* The needle's reading of the same; false until eight time constants have passed. */
bool phase_meter_analog(const phase_meter_t *m, uint32_t *lag_q32);

#ifdef __cplusplus
}
#endif

#endif
