#include "scan.h"

#include <errno.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "clock.h"

static int             timer = -1;
static scan_counters_t counted;

static struct timespec timespec_of_ns(uint64_t ns)
{
    return (struct timespec){
        .tv_sec = (time_t)(ns / CLOCK_NS_PER_S),
        .tv_nsec = (long)(ns % CLOCK_NS_PER_S),
    };
}

int scan_start(uint32_t period_us)
{
    uint64_t          period_ns = (uint64_t)period_us * CLOCK_NS_PER_US;
    struct itimerspec times = {
        .it_value = timespec_of_ns(clock_now_ns() + period_ns),
        .it_interval = timespec_of_ns(period_ns),
    };
    scan_stop();
    counted = (scan_counters_t){0};
    timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    if (timer < 0 || timerfd_settime(timer, TFD_TIMER_ABSTIME, &times, NULL) != 0) {
        return errno;
    }
    return 0;
}

void scan_stop(void)
{
    if (timer >= 0) {
        (void)close(timer);
    }
    timer = -1;
}

int scan_fd(void)
{
    return timer;
}

void scan_count(scan_counters_t *counters, uint64_t expirations)
{
    if (expirations > 0u) {
        ++counters->scans;
        counters->overruns += expirations - 1u;
    }
}

bool scan_take(void)
{
    uint64_t expirations = 0u;
    if (timer < 0 || read(timer, &expirations, sizeof expirations) != (ssize_t)sizeof expirations) {
        return false;
    }
    scan_count(&counted, expirations);
    return expirations > 0u;
}

scan_counters_t scan_counters(void)
{
    return counted;
}
