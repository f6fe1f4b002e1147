#include "scan.h"

/* Number of the first scan at or after `time`. */
static int64_t number_at(const sim_scan_t *scan, sim_ns_t time)
{
    return time <= scan->phase ? 0 : (time - scan->phase + scan->period - 1) / scan->period;
}

void sim_scan_init(sim_scan_t *scan, sim_ns_t phase, sim_ns_t period, sim_ns_t now)
{
    *scan = (sim_scan_t){.phase = phase, .period = period};
    sim_scan_restart(scan, now);
}

void sim_scan_restart(sim_scan_t *scan, sim_ns_t now)
{
    scan->last = number_at(scan, now) - 1;
    scan->next_at = SIM_NEVER;
}

void sim_scan_await(sim_scan_t *scan, sim_ns_t time)
{
    if (time == SIM_NEVER) {
        scan->next_at = SIM_NEVER;
        return;
    }
    int64_t number = number_at(scan, time);
    scan->next = number > scan->last ? number : scan->last + 1;
    scan->next_at = scan->phase + scan->next * scan->period;
}

int64_t sim_scan_execute(sim_scan_t *scan)
{
    int64_t left_out = scan->next - scan->last - 1;
    scan->last = scan->next;
    return left_out;
}
