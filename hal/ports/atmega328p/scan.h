/*
 * The scans of the PLC task: Timer2, reloaded by hardware, so that a late scan moves no later one.
 */
#ifndef ATMEGA328P_SCAN_H
#define ATMEGA328P_SCAN_H

#include <stdbool.h>
#include <stdint.h>

/*
 * From now on scan_on_time() comes every period: 100 µs to 16320 µs, and a whole number of the
 * timer's ticks (4 µs up to 1024 µs, 8 µs up to 2048 µs, 16 µs up to 4096 µs, else 64 µs). Task.
 * Returns HAL_OK or HAL_ERR_CONFIG.
 */
int scan_start(uint16_t period_us);

/* Whether a scan is due, and run it if it is. Deferred work. */
bool scan_is_due(void);
void scan_run(void);

/* deferred.c: a scan has fallen due. Last in the interrupt of the timer. */
void scan_on_due(void);

/*
 * main.c: one scan. Interrupt, but with interrupts on, so that a scan delays no edge. A scan that
 * is still running when the next falls due makes that one late; of several only one comes.
 */
void scan_on_time(void);

#endif
