#include "loop.h"

#include <poll.h>
#include <stdbool.h>
#include <stdint.h>

#include "bus.h"
#include "clock.h"
#include "edge.h"
#include "say.h"
#include "scan.h"

#define ROUND_MS   1000 /* so often the task runs at least: its ticks must not wrap unseen */
#define RECOVER_MS 100  /* between attempts to get a line or an interface back */
#define NS_PER_MS  1000000u

enum { EDGE, SCAN, BUS, SIGNAL, SOURCES };

static uint64_t tried_at_ns; /* the last attempt to recover */

static int shorter_ms(int a, int b)
{
    return a >= 0 && a < b ? a : b;
}

static bool is_anything_gone(void)
{
    return edge_is_lost() || bus_is_down();
}

/* How long it may sleep before something that cannot wake it has to be tried again. */
static int limit_ms(int timeout_ms, bool is_flushed)
{
    int limit = shorter_ms(timeout_ms, is_anything_gone() ? RECOVER_MS : ROUND_MS);
    return is_flushed || bus_is_down() ? limit : shorter_ms(limit, BUS_RETRY_MS);
}

/* Not oftener than RECOVER_MS, however often the scans wake the loop. */
static void recover(void)
{
    uint64_t now_ns = clock_now_ns();
    if (!is_anything_gone() || now_ns - tried_at_ns < RECOVER_MS * (uint64_t)NS_PER_MS) {
        return;
    }
    tried_at_ns = now_ns;
    if (edge_is_lost() && edge_recover()) {
        say("the line is back");
    }
    if (bus_is_down()) {
        bus_recover();
    }
}

static void run_edges(const loop_calls_t *calls)
{
    edge_fetch();
    while (edge_deliver()) {
        calls->task();
    }
}

/*
 * The scan reads line, clock and position one after the other, and the line takes the longest by
 * far: a position captured before it would not be that of the stamp. Periods are counted after the
 * scan, as reading the timer first would make every scan later.
 */
static void run_scan(const loop_calls_t *calls)
{
    calls->on_scan();
    (void)scan_take();
}

static void see_to(const struct pollfd watched[SOURCES], const loop_calls_t *calls)
{
    if (watched[EDGE].revents != 0) {
        run_edges(calls);
    }
    if (watched[SCAN].revents != 0) {
        run_scan(calls);
    }
    if (watched[BUS].revents != 0) {
        bus_receive();
    }
    if (watched[SIGNAL].revents != 0) {
        calls->on_signal();
    }
}

void loop_run_once(const loop_calls_t *calls, int timeout_ms)
{
    bool          was_lost = edge_is_lost();
    bool          is_flushed = bus_flush();
    struct pollfd watched[SOURCES] = {
        [EDGE] = {.fd = edge_fd(), .events = POLLIN},
        [SCAN] = {.fd = scan_fd(), .events = POLLIN},
        [BUS] = {.fd = bus_fd(), .events = POLLIN},
        [SIGNAL] = {.fd = calls->signals, .events = POLLIN},
    };
    if (poll(watched, SOURCES, limit_ms(timeout_ms, is_flushed)) > 0) {
        see_to(watched, calls);
    }
    calls->task();
    (void)bus_flush();
    if (edge_is_lost() && !was_lost) {
        say("the line is gone: no edges until its chip is back");
    }
    recover();
}
