/*
 * What a board of this family adds to the port under test, beside its facts: the emulator has wired
 * one of its outputs to the trigger pin, and brings back what the port's UART sends; a timer that
 * the port does not use tells the time.
 */
#ifndef ARM_WIRED_BOARD_H
#define ARM_WIRED_BOARD_H

#include <stdbool.h>
#include <stdint.h>

/* Of wired_ticks(). */
extern const uint32_t WIRED_TICKS_PER_US;

/* The interrupt of the port's UART. */
extern const uint32_t WIRED_UART_IRQ;

/* Start the timer and what hears, and the line's driver. The port has been started. Task. */
void wired_start(void);

/* Counts up and wraps at 2^32. */
uint32_t wired_ticks(void);

/* Drive the trigger line. Task. */
void wired_set_line(bool high);

/* Take a byte that was sent and has come back, or -1. Task. */
int wired_hear(void);

#endif
