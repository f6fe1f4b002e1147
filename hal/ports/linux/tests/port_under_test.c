/*
 * The Linux port under test, on a line of gpio-sim, which BENCH_PULLS drives, and a virtual CAN
 * interface, on whose other end a socket of its own listens. tests/bench/devices.sh makes both and
 * sets the variables; without them every test is ignored, and says so.
 */
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "../axis.h"
#include "../bus.h"
#include "../clock.h"
#include "../edge.h"
#include "../loop.h"
#include "contract/port_under_test.h"
#include "hal_clock.h"
#include "unity.h"

#define LATCH_ID      0x181u
#define LINE          0u
#define PATH_SIZE     256u
#define RECEIVE_BYTES (1 << 20)
#define NS_PER_MS     1000000u

/* An emulated machine on a busy host stands still for many milliseconds now and then. */
#define STALL_US 20000u

const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = true,
    .filter_max_us = UINT16_MAX,
    .filter_tried_us = 3u * STALL_US,
    .edge_latency_us = STALL_US,
    .frame_latency_us = STALL_US,
    .time_error_us = STALL_US,
};

static int recorder = -1;

static const char *variable(const char *name)
{
    const char *value = getenv(name);
    if (value == NULL) {
        TEST_IGNORE_MESSAGE("no gpio-sim and vcan here: modprobe gpio-sim vcan, and as root "
                            "source tests/bench/devices.sh");
    }
    return value;
}

static void no_task(void)
{
}

static const loop_calls_t CALLS = {.task = no_task, .signals = -1};

/* ---- the line ---- */

void port_set_line(uint8_t channel, bool high)
{
    char        path[PATH_SIZE];
    const char *pull = high ? "pull-up" : "pull-down";
    if (channel != 0u) {
        return;
    }
    (void)snprintf(path, sizeof path, "%s/sim_gpio%u/pull", variable("BENCH_PULLS"), LINE);
    int     file = open(path, O_WRONLY | O_CLOEXEC);
    ssize_t written = file >= 0 ? write(file, pull, strlen(pull)) : -1;
    (void)close(file);
    TEST_ASSERT_EQUAL_INT_MESSAGE(strlen(pull), written, path);
}

/* ---- the recorder ---- */

static void open_recorder(const char *interface)
{
    const int           bytes = RECEIVE_BYTES;
    struct sockaddr_can address = {
        .can_family = AF_CAN,
        .can_ifindex = (int)if_nametoindex(interface),
    };
    if (recorder >= 0) {
        (void)close(recorder);
    }
    recorder = socket(AF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    (void)setsockopt(recorder, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, bind(recorder, (const struct sockaddr *)&address, sizeof address), interface);
}

bool port_receive(uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    struct can_frame received;
    if (read(recorder, &received, sizeof received) != (ssize_t)sizeof received) {
        return false;
    }
    TEST_ASSERT_EQUAL_HEX32(LATCH_ID, received.can_id);
    TEST_ASSERT_EQUAL_UINT8(HAL_BUS_FRAME_BYTES, received.len);
    memcpy(frame, received.data, HAL_BUS_FRAME_BYTES);
    return true;
}

/* ---- the rest ---- */

void port_power_up(void)
{
    const char       *interface = variable("BENCH_CAN");
    const edge_line_t line = {
        .chip = variable("BENCH_CHIP"),
        .offset = LINE,
        .consumer = "contract",
    };
    port_set_line(0u, false);
    axis_place(0);
    clock_shift_ticks(0u);
    TEST_ASSERT_EQUAL_INT(0, edge_open(&line));
    TEST_ASSERT_EQUAL_INT(0, bus_open(interface, LATCH_ID));
    open_recorder(interface);
}

bool port_power_up_at(uint32_t ticks)
{
    port_power_up();
    clock_shift_ticks(ticks - hal_clock_now_ticks());
    return true;
}

/* The last round comes after the time is over: what is due by then is delivered. */
void port_pass_us(uint32_t us)
{
    uint64_t end_ns = clock_now_ns() + (uint64_t)us * CLOCK_NS_PER_US;
    uint64_t now_ns = 0u;
    do {
        now_ns = clock_now_ns();
        uint64_t left_ms = now_ns < end_ns ? (end_ns - now_ns) / NS_PER_MS : 0u;
        loop_run_once(&CALLS, left_ms > 1u ? (int)left_ms - 1 : 0);
    } while (now_ns < end_ns);
}

void port_place_axis(uint8_t axis, int32_t position_counts)
{
    if (axis == 0u) {
        axis_place(position_counts);
    }
}
