/*
 * What this board alone has: its clocks, and who has which timer. TIMER is the device clock, and
 * its alarm 0 a disturbance's; PWM slice 0 makes the steps of the axis, slice 1 is left free;
 * SysTick makes the PLC's scans.
 *
 * Priorities: the trigger line highest; then steps, scans, UART.
 */
#ifndef RP2040_BOARD_H
#define RP2040_BOARD_H

#include <stdint.h>

#define BOARD_CORE_MHZ     125u
#define BOARD_TICKS_PER_US 1u /* of the device clock */

/* The core that the edge interrupts; 1 in the build that has wiring_two_cores.c. */
#ifndef BOARD_EDGE_CORE
#define BOARD_EDGE_CORE 0u
#endif

/* PWM slices. */
#define SLICE_AXIS 0u
#define SLICE_FREE 1u

/* A slice counts µs from 0, and begins anew after `top` (at most 65535). Task. */
void board_start_slice(uint32_t slice, uint32_t top);

/* The vector of the axis: it has made a step. Interrupt. */
void axis_on_step(void);

#endif
