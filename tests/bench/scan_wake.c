/*
 * How late the scans of the PLC path wake up: runs the port's own scan timer and loop.
 *
 *   scan_wake PERIOD_US COUNT FIFO_PRIORITY CPU >lateness_ns
 *
 * One line a scan, in ns after it was due; priority 0, which needs no privilege, and processor −1
 * leave things as they are.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/timerfd.h>

#include "../hal/ports/linux/axis.h"
#include "../hal/ports/linux/clock.h"
#include "../hal/ports/linux/loop.h"
#include "../hal/ports/linux/realtime.h"
#include "../hal/ports/linux/scan.h"
#include "hal_axis.h"
#include "hal_edge_events.h"

#define TRIES        20u
#define AXIS         0u
#define COUNTS_PER_S 1e9

static uint64_t  period_ns;
static uint64_t  grid_ns; /* an instant at which a scan was due */
static uint64_t  scans;
static uint64_t  wanted;
static uint64_t *lateness_ns;

/* The loop wants a task and an edge's taker; this program has no use for them. */
static void no_task(void)
{
}

void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel;
    (void)captured_ticks;
}

/*
 * When the port took this scan to begin: the first thing it does once awake, as cyclictest does. At
 * COUNTS_PER_S the axis counts ns, and within a scan it stands at that instant.
 */
static uint64_t scan_began_ns(void)
{
    uint32_t captured = (uint32_t)hal_axis_position_counts(AXIS);
    uint64_t now_ns = clock_now_ns();
    return now_ns - (uint32_t)((uint32_t)now_ns - captured);
}

static void on_scan(void)
{
    if (scans < wanted) {
        lateness_ns[scans] = (scan_began_ns() - grid_ns) % period_ns;
        ++scans;
    }
}

/*
 * When the timer is due next, from the time it says is left; the try with the least time around it
 * counts.
 */
static uint64_t due_ns(void)
{
    uint64_t best_ns = UINT64_MAX;
    uint64_t due = 0u;
    for (unsigned i = 0; i < TRIES; ++i) {
        struct itimerspec left;
        uint64_t          before_ns = clock_now_ns();
        (void)timerfd_gettime(scan_fd(), &left);
        uint64_t took_ns = clock_now_ns() - before_ns;
        if (took_ns < best_ns) {
            best_ns = took_ns;
            due = before_ns + took_ns / 2u + (uint64_t)left.it_value.tv_sec * CLOCK_NS_PER_S +
                  (uint64_t)left.it_value.tv_nsec;
        }
    }
    return due - 1000u * period_ns;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fputs("usage: scan_wake PERIOD_US COUNT FIFO_PRIORITY CPU\n", stderr);
        return 2;
    }
    uint32_t period_us = (uint32_t)strtoul(argv[1], NULL, 10);
    int      priority = atoi(argv[3]);
    int      cpu = atoi(argv[4]);
    wanted = strtoull(argv[2], NULL, 10);
    lateness_ns = calloc(wanted, sizeof *lateness_ns);
    if (lateness_ns == NULL || (cpu >= 0 && realtime_pin(cpu) != 0) ||
        (priority > 0 && (realtime_lock_memory() != 0 || realtime_fifo(priority) != 0)) ||
        scan_start(period_us) != 0) {
        return 2;
    }
    period_ns = (uint64_t)period_us * CLOCK_NS_PER_US;
    grid_ns = due_ns();
    axis_run(COUNTS_PER_S);

    const loop_calls_t calls = {.on_scan = on_scan, .task = no_task, .signals = -1};
    while (scans < wanted) {
        loop_run_once(&calls, -1);
    }
    for (uint64_t i = 0; i < scans; ++i) {
        printf("%llu\n", (unsigned long long)lateness_ns[i]);
    }
    fprintf(stderr, "%llu overruns\n", (unsigned long long)scan_counters().overruns);
    free(lateness_ns);
    return 0;
}
