/*
 * The gating train's pulses, for transmission.c alone: they wait for the denser train's next pulse,
 * and then each is counted and makes a point. A file of its own, so that a small processor goes
 * through the many pulses of the denser train without the registers that the points take.
 */
#ifndef COMP_TRANSMISSION_GATE_H
#define COMP_TRANSMISSION_GATE_H

#include "comp/transmission.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Lines of the denser train that the shafts may part by; a step of either train is far less. */
#define TRANSMISSION_LINES_MOST (INT32_C(1) << 30)

/* The shafts have parted further than that: counting goes on, but from another zero. */
void transmission_gate_shift_zero(transmission_t *t);

static inline bool transmission_gate_is_full(const transmission_t *t)
{
    return t->lines > TRANSMISSION_LINES_MOST || t->lines < -TRANSMISSION_LINES_MOST;
}

void transmission_gate_on_pulse(transmission_t *t, uint32_t ticks, int8_t sense);

/* Count those that came while the denser train moved on by `dense_lines` in the interval. */
void transmission_gate_place(transmission_t *t, uint32_t interval_ticks, uint8_t dense_lines);

/* Count those that wait without making points of them; nothing that was is compared any more. */
void transmission_gate_give_up(transmission_t *t);

#ifdef __cplusplus
}
#endif

#endif
