/* How long the interrupts of a simulated AVR take, and how long the trigger's edge waits for its
 * own. */
#ifndef SIMAVR_RIG_INTERRUPTS_H
#define SIMAVR_RIG_INTERRUPTS_H

#include <simavr/sim_avr.h>
#include <stdbool.h>
#include <stdint.h>

/* Watch all interrupts from now on. */
void interrupts_listen(avr_t *of);

/* An edge has come just now. */
void interrupts_await_edge(void);

/* Whether one is running. */
bool interrupts_are_running(void);

/* Cycles spent in all of them. */
uint64_t interrupts_busy_cycles(void);

/*
 * Print, a line for each vector that was taken:
 *
 *   body VECTOR CALLS LEAST MEAN_X1000 MOST   cycles from the vector to the end of its reti, less
 *                                             those of interrupts inside it
 *   wait VECTOR CALLS LEAST MEAN_X1000 MOST   of the edge's: cycles from the edge to the vector
 */
void interrupts_print(void);

#endif
