/*
 * The one loop of this port: waits for edges, scans, frames and signals, and calls for each what
 * stands in for its interrupt. Between any two of them it runs the task.
 */
#ifndef LINUX_LOOP_H
#define LINUX_LOOP_H

typedef struct {
    void (*task)(void);      /* after every edge and scan, and at least once a second */
    void (*on_scan)(void);   /* for scan.h; NULL if there are no scans */
    void (*on_signal)(void); /* `signals` can be read; NULL if there are none */
    int signals;             /* a descriptor, or negative */
} loop_calls_t;

/* One round: wait for something to happen or `timeout_ms` (negative: any time), and see to it. */
void loop_run_once(const loop_calls_t *calls, int timeout_ms);

#endif
