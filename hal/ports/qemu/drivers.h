/*
 * What the boards that run in QEMU or rp2040js have beyond hal/include, for their common wiring and
 * their tests: its start, an axis that moves by itself, scans, the UART's two ways. Each board's
 * own `board.h` says BOARD_TICKS_PER_US, the ticks of its clock, before a disturbance makes them
 * coarser.
 */
#ifndef QEMU_DRIVERS_H
#define QEMU_DRIVERS_H

#include <stdbool.h>
#include <stdint.h>

/* Clocks and pins; then every driver below. Task, once. */
void board_start(void);

/* ---- clock.c ---- */

/*
 * The device clock runs, and stands just at `ticks`. One of 24 bits that is counted on must have
 * some 100 ticks left before they wrap. Task, edges and scans not yet delivered.
 */
void clock_start(uint32_t ticks);

/* ---- edge.c ---- */

void edge_start(void);

/* True while the pin is high, before polarity and software filter. Any context. */
bool edge_pin_is_high(void);

/* The vector of the pin. Interrupt. */
void edge_interrupt(void);

/* ---- axis.c ---- */

/* Put the axis to `position_counts`, at rest. Task. */
void axis_place(int32_t position_counts);

/* From 0 on, at once, upwards at `feed_mm_per_min`; 0 lets it rest there. Task. */
void axis_run(uint32_t feed_mm_per_min);

/* ---- scan.c ---- */

/* From now on board_on_scan() comes every period. Task, once. */
void scan_start(uint16_t period_us);

/* The vector of the scan timer. Interrupt. */
void scan_interrupt(void);

/* main.c, tests: one scan of the PLC. Interrupt. */
void board_on_scan(void);

/* ---- bus.c, over the board's uart.c ---- */

/* The report bus, empty. Task. */
void bus_start(void);

/* The vector of the UART: a byte has left. Interrupt. */
void bus_interrupt(void);

/* Both ways at 115,200 baud, an interrupt for each byte that has left. Task. */
void uart_start(void);

/* Take back the request of that interrupt. Interrupt. */
void uart_forget_sent(void);

/* Send a byte; the one before has left. Interrupt, or masked. */
void uart_send_byte(uint8_t byte);

/* A byte that has come in, or -1 if there is none; none is lost if asked every 80 µs. Task. */
int uart_take_byte(void);

#endif
