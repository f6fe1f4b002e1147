/*
 * What this board has beyond hal/include: its start, the timer interrupts, the axis that the steps
 * make, the command bytes.
 *
 * Who has which timer: 0 the disturbance, 1 the PLC's scans, 2 the steps of the axis; 3 is left
 * free. Priorities: clock and trigger line highest and alike, so that neither interrupts the other;
 * then steps, scans, UART.
 */
#ifndef CORTEX_M3_BOARD_H
#define CORTEX_M3_BOARD_H

#include <stdbool.h>
#include <stdint.h>

#define BOARD_TICKS_PER_US 50u /* core clock, timers and SysTick alike */

#define TIMER_DISTURBANCE 0u
#define TIMER_SCAN        1u
#define TIMER_AXIS        2u

typedef enum {
    PRIORITY_EDGE = 0, /* SysTick has it after reset */
    PRIORITY_AXIS = 1,
    PRIORITY_SCAN = 2,
    PRIORITY_UART = 3
} board_priority_t;

/* Clocks and pins; then every driver below. Task, once. */
void board_start(void);

/* Let an interrupt come, 0 … 47, one that was pending before not. Task. */
void board_enable_irq(uint32_t irq, board_priority_t priority);

/* Timer `number` (0 … 3) interrupts every `period_ticks` (> 0) of the core clock. Task. */
void board_start_timer(uint32_t number, uint32_t period_ticks);

/* ---- clock.c ---- */

/*
 * The device clock runs, and stands just at `ticks`. Its low 24 bits must leave some 100 ticks
 * before they wrap. Task, edges and scans not yet delivered.
 */
void clock_start(uint32_t ticks);

/* The vector of SysTick. Interrupt. */
void clock_on_wrap(void);

/* ---- edge.c ---- */

void edge_start(void);

/* True while the pin is high, before polarity and software filter. Any context. */
bool edge_pin_is_high(void);

/* The vector of the pin's port. Interrupt. */
void edge_interrupt(void);

/* An edge behind a software filter, seen just now. Interrupt. */
void edge_on_filtered(bool is_high);

/* ---- axis.c ---- */

/* Put the axis to `position_counts`, at rest. Task. */
void axis_place(int32_t position_counts);

/* From 0 on, at once, one count up every `period_ticks`; 0 lets it rest there. Task. */
void axis_run(uint32_t period_ticks);

/* The vector of the step timer. Interrupt. */
void axis_on_step(void);

/* ---- scan.c ---- */

/* From now on board_on_scan() comes every period. Task, once. */
void scan_start(uint16_t period_us);

/* The vector of the scan timer. Interrupt. */
void scan_interrupt(void);

/* main.c, tests: one scan of the PLC. Interrupt. */
void board_on_scan(void);

/* ---- bus.c ---- */

void bus_start(void);

/* A byte that has come in, or -1 if there is none; none is lost if asked every 80 µs. Task. */
int bus_take_byte(void);

/* The vector of the UART. Interrupt. */
void bus_interrupt(void);

#endif
