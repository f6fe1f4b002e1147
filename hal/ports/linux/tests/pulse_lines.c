/*
 * The pulse lines of the Linux port: lines 1 and 2 of gpio-sim, which BENCH_PULLS drives. Without
 * the devices of tests/bench/devices.sh every test is ignored, and says so.
 */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "../clock.h"
#include "../pulse.h"
#include "contract/pulse_lines_under_test.h"
#include "hal_clock.h"
#include "unity.h"

#define PATH_SIZE 256u

/* An emulated machine on a busy host stands still for many milliseconds now and then. */
const pulse_facts_t PULSES = {.latency_us = 20000u, .spacing_us = 2000u, .held_most = PULSE_HELD};

static const uint32_t LINES[HAL_PULSE_CHANNELS] = {1u, 2u};

static const char *variable(const char *name)
{
    const char *value = getenv(name);
    if (value == NULL) {
        TEST_IGNORE_MESSAGE("no gpio-sim here: modprobe gpio-sim vcan, and as root "
                            "source tests/bench/devices.sh");
    }
    return value;
}

void pulse_line_set(uint8_t channel, bool high)
{
    char        path[PATH_SIZE];
    const char *pull = high ? "pull-up" : "pull-down";
    (void)snprintf(path, sizeof path, "%s/sim_gpio%u/pull", variable("BENCH_PULLS"),
                   LINES[channel]);
    int     file = open(path, O_WRONLY | O_CLOEXEC);
    ssize_t written = file >= 0 ? write(file, pull, strlen(pull)) : -1;
    (void)close(file);
    TEST_ASSERT_EQUAL_INT_MESSAGE(strlen(pull), written, path);
}

void pulse_lines_power_up(uint32_t ticks)
{
    const pulse_lines_t lines = {
        .chip = variable("BENCH_CHIP"),
        .offsets = {LINES[0], LINES[1]},
        .consumer = "contract",
    };
    pulse_line_set(0u, false);
    pulse_line_set(1u, false);
    TEST_ASSERT_EQUAL_INT(0, pulse_open(&lines));
    clock_shift_ticks(0u);
    clock_shift_ticks(ticks - hal_clock_now_ticks());
}

void pulse_lines_pass_us(uint32_t us)
{
    const struct timespec time = {
        .tv_sec = us / 1000000u,
        .tv_nsec = (long)(us % 1000000u) * 1000L,
    };
    (void)nanosleep(&time, NULL);
}
