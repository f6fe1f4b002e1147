#include "scan.h"

#include <math.h>
#include <stddef.h>

#define MOST_LATE_SCANS 100.0 /* how far back a late scan is felt at most */

static sim_ns_t due_at(const sim_scan_t *scan, int64_t number)
{
    return scan->phase + (sim_ns_t)rint((double)number * scan->period_ns);
}

/* Number of the first scan at or after `time`. */
static int64_t number_at(const sim_scan_t *scan, sim_ns_t time)
{
    if (time <= scan->phase) {
        return 0;
    }
    int64_t number = (int64_t)((double)(time - scan->phase) / scan->period_ns);
    while (number > 0 && due_at(scan, number - 1) >= time) {
        --number;
    }
    while (due_at(scan, number) < time) {
        ++number;
    }
    return number;
}

void sim_scan_init(sim_scan_t *scan, sim_ns_t phase, double period_ns, sim_ns_t now)
{
    *scan = (sim_scan_t){.phase = phase, .period_ns = period_ns};
    sim_scan_restart(scan, now);
}

void sim_scan_restart(sim_scan_t *scan, sim_ns_t now)
{
    scan->last = number_at(scan, now) - 1;
    scan->next_at = SIM_NEVER;
}

/* A scan that was due before `time` may begin after it, or hold up the ones behind it. */
static void await_late(sim_scan_t *scan, sim_ns_t time)
{
    int64_t  newest = scan->next;
    sim_ns_t begin = 0;
    int64_t  felt = (int64_t)fmin(ceil((double)scan->latest / scan->period_ns), MOST_LATE_SCANS);
    for (int64_t number = newest > felt ? newest - felt : 0; number <= newest; ++number) {
        sim_ns_t due = due_at(scan, number) + scan->late(scan->context, number);
        begin = due > begin ? due : begin;
        if (number > scan->last && begin >= time) {
            scan->next = number;
            break;
        }
    }
    scan->next_at = begin;
}

void sim_scan_shift(sim_scan_t *scan, sim_ns_t by)
{
    scan->phase += by;
    scan->shifted += by;
}

void sim_scan_shift_back(sim_scan_t *scan)
{
    scan->phase -= scan->shifted;
    scan->shifted = 0;
}

void sim_scan_await(sim_scan_t *scan, sim_ns_t time)
{
    if (time == SIM_NEVER) {
        scan->next_at = SIM_NEVER;
        return;
    }
    int64_t number = number_at(scan, time);
    scan->next = number > scan->last ? number : scan->last + 1;
    scan->next_at = due_at(scan, scan->next);
    if (scan->late != NULL) {
        await_late(scan, time);
    }
}

int64_t sim_scan_execute(sim_scan_t *scan)
{
    int64_t left_out = scan->next - scan->last - 1;
    scan->last = scan->next;
    return left_out;
}
