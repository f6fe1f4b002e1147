/*
 * What this board alone has. The device clock is the core's count of cycles; CLINT's timer, of a
 * clock of 1 MHz, makes the PLC's scans, its software interrupt is the disturbing one. Both PWMs
 * are left free.
 *
 * The trigger line and the disturbing interrupt let nothing in; a scan lets both in.
 */
#ifndef SIFIVE_U_BOARD_H
#define SIFIVE_U_BOARD_H

#define BOARD_CYCLE_SHIFT  3u   /* 2^3 cycles of 1 ns are a tick */
#define BOARD_TICKS_PER_US 125u /* of the device clock: 8 ns */

#endif
