/*
 * What this board alone has: its timers and their interrupts.
 *
 * Who has which timer: 0 the disturbance, 1 the PLC's scans, 2 the steps of the axis; 3 is left
 * free. Priorities: clock and trigger line highest and alike, so that neither interrupts the other;
 * then steps, scans, UART.
 */
#ifndef CORTEX_M3_BOARD_H
#define CORTEX_M3_BOARD_H

#include <stdint.h>

#define BOARD_TICKS_PER_US 50u /* core clock, timers and SysTick alike */

#define TIMER_DISTURBANCE 0u
#define TIMER_SCAN        1u
#define TIMER_AXIS        2u

/* Timer `number` (0 … 3) interrupts every `period_ticks` (> 0) of the core clock. Task. */
void board_start_timer(uint32_t number, uint32_t period_ticks);

/* clock.c: the vector of SysTick. Interrupt. */
void clock_on_wrap(void);

/* axis.c: the vector of the step timer. Interrupt. */
void axis_on_step(void);

#endif
