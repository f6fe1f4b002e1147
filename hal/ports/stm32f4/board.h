/*
 * What this board alone has: its clocks, and who has which timer. TIM2 is the device clock, TIM5
 * the axis, SysTick the PLC's scans; TIM4 is left free.
 *
 * Priorities: the trigger line highest; then scans, UART.
 */
#ifndef STM32F4_BOARD_H
#define STM32F4_BOARD_H

#include <stdint.h>

/* What 8 MHz make: core 160 MHz, APB1 at 40 MHz with its timers at twice that. */
#ifndef BOARD_CORE_MHZ
#define BOARD_CORE_MHZ  160u
#define BOARD_TIMER_MHZ 80u
#endif

/* 0 where the clocks run as they shall from reset on. */
#ifndef BOARD_SETS_CLOCKS
#define BOARD_SETS_CLOCKS 1
#endif

#define BOARD_TICKS_PER_US 40u /* of the device clock: 25 ns */

/* A timer of 32 bits counts up from `count`, once every `cycles` (1 … 65536) of its clock. Task. */
void board_start_counter(uint32_t tim, uint32_t cycles, uint32_t count);

#endif
