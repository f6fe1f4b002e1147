/*
 * The scan timer of the PLC path: a periodic timerfd on CLOCK_MONOTONIC. A scan that comes late
 * moves no later one; periods that went by meanwhile are lost scans, and counted.
 */
#ifndef LINUX_SCAN_H
#define LINUX_SCAN_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t scans;    /* that ran */
    uint64_t overruns; /* periods that passed without a scan of their own */
} scan_counters_t;

/* Begin: the first scan is due one period from now. 0, or an errno. */
int scan_start(uint32_t period_us);

void scan_stop(void);

/* To be polled for reading; negative while there is no timer. */
int scan_fd(void);

/* Count the periods that have passed; false if none has. */
bool scan_take(void);

/* Account for one wake-up after `expirations` periods. */
void scan_count(scan_counters_t *counters, uint64_t expirations);

scan_counters_t scan_counters(void);

#endif
