/*
 * What a board in QEMU adds to the port under test, beside its facts: the emulator has wired one of
 * its outputs to the trigger pin; a timer that the port does not use tells the time.
 */
#ifndef QEMU_WIRED_BOARD_H
#define QEMU_WIRED_BOARD_H

#include <stdbool.h>
#include <stdint.h>

/* Of wired_ticks(). */
extern const uint32_t WIRED_TICKS_PER_US;

/* Let the interrupt of the port's UART come, or not. Task. */
void wired_let_uart(bool may_interrupt);

/* Start the timer, and the line's driver. The port has been started. Task. */
void wired_start(void);

/* Counts up and wraps at 2^32. */
uint32_t wired_ticks(void);

/* Drive the trigger line. Task. */
void wired_set_line(bool high);

#endif
