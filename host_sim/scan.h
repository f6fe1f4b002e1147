/*
 * Scan stage: when the PLC's scans begin. They run at phase + k·period all the time; scans in which
 * nothing can happen are left out and only counted.
 */
#ifndef SIM_SCAN_H
#define SIM_SCAN_H

#include "sim_time.h"

/* By how much scan `number` begins late, ≥ 0; scans do not overtake. */
typedef sim_ns_t sim_scan_late_t(void *context, int64_t number);

typedef struct {
    sim_ns_t         phase;     /* of scan 0, within a period */
    sim_ns_t         shifted;   /* by which it was moved */
    double           period_ns; /* of no whole number: over an hour a nanosecond's rest adds up */
    int64_t          last;      /* number of the last scan that was executed */
    int64_t          next;      /* number of the next one to execute */
    sim_ns_t         next_at;   /* when, or SIM_NEVER */
    sim_scan_late_t *late;      /* NULL: never late */
    sim_ns_t         latest;    /* no scan begins later than by this */
    void            *context;
} sim_scan_t;

/* Scans run at `phase` + k·`period_ns`, rounded, and none is wanted yet. */
void sim_scan_init(sim_scan_t *scan, sim_ns_t phase, double period_ns, sim_ns_t now);

/* The task stops, and when it runs again, the scans before `now` are past, executed or not. */
void sim_scan_restart(sim_scan_t *scan, sim_ns_t now);

/* Move all scans by `by`, less than a period. */
void sim_scan_shift(sim_scan_t *scan, sim_ns_t by);

/* Move all scans back to where they were at first. */
void sim_scan_shift_back(sim_scan_t *scan);

/* Execute next the first scan at or after `time`; SIM_NEVER stops the task. */
void sim_scan_await(sim_scan_t *scan, sim_ns_t time);

/* The next scan is executed: returns how many were left out before it. */
int64_t sim_scan_execute(sim_scan_t *scan);

#endif
