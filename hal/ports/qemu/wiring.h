/*
 * The wiring of these boards: the trigger line into the skip input and into a PLC task whose scans
 * run all the time, one of the two latching, its records to the UART.
 *
 * A byte on the UART says what to do: 's' latches every edge on the skip path, 'p' on the PLC path,
 * 'n' on none; '1', '2' and '3' let the axis run from 0 at 100, 1000 and 3000 mm/min, '0' stops it.
 */
#ifndef QEMU_WIRING_H
#define QEMU_WIRING_H

#include <stdbool.h>

/* The board, both inputs, scans of 1 ms. False if it lacks what the wiring asks for. Task, once. */
bool wiring_start(void);

/* One scan of the PLC. Interrupt. */
void wiring_scan(void);

/* What the task does, once around. Task. */
void wiring_round(void);

#endif
