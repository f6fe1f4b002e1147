#include "injector.h"

#include <errno.h>
#include <poll.h>
#include <stddef.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

#include "can_socket.h"
#include "clock.h"
#include "say.h"

#define NS_PER_MS     1000000u
#define RETRY_SEND_US 500u /* the kernel would not take a frame: the bus is busy or down */

static uint32_t now_us(void)
{
    return (uint32_t)(clock_now_ns() / CLOCK_NS_PER_US);
}

static uint64_t now_ms(void)
{
    return clock_now_ns() / NS_PER_MS;
}

/* ---- reports ---- */

static bool send(int can_fd, const injector_report_t *report)
{
    struct can_frame frame = {.can_id = report->id, .len = INJECT_FRAME_BYTES};
    memcpy(frame.data, report->bytes, INJECT_FRAME_BYTES);
    return can_socket_send(can_fd, &frame) == 0;
}

/* Hand on what the bus takes now, in order. */
static void flush(injector_t *injector)
{
    while (injector->queue_count != 0u &&
           send(injector->can_fd, &injector->queue[injector->queue_first])) {
        injector->queue_first = (injector->queue_first + 1u) % INJECTOR_QUEUE_LENGTH;
        --injector->queue_count;
    }
}

static void report(injector_t *injector, uint16_t id, const uint8_t *frame)
{
    if (injector->queue_count == INJECTOR_QUEUE_LENGTH) {
        inject_guard_count(&injector->guard.dropped_frames, 1u);
        return;
    }
    uint32_t end = (injector->queue_first + injector->queue_count) % INJECTOR_QUEUE_LENGTH;
    injector->queue[end].id = id;
    memcpy(injector->queue[end].bytes, frame, INJECT_FRAME_BYTES);
    ++injector->queue_count;
}

static void report_status(injector_t *injector, uint8_t page, inject_verdict_t verdict)
{
    uint8_t frame[INJECT_FRAME_BYTES];
    inject_guard_report(&injector->guard, page, verdict, (uint8_t)injector->status_counter,
                        now_ms(), frame);
    ++injector->status_counter;
    report(injector, INJECT_ID_STATUS, frame);
}

static uint8_t bits_of(uint64_t window_ns)
{
    uint8_t bits = 0u;
    while (bits < INJECT_WINDOW_BITS_MAX && (uint64_t)1u << bits < window_ns) {
        ++bits;
    }
    return bits;
}

static void note_edge(injector_t *injector, uint8_t level, uint64_t before_ns, uint64_t after_ns)
{
    injector->edge = (inject_edge_t){
        .time_ns = before_ns,
        .number = (uint16_t)injector->edges,
        .window_bits = bits_of(after_ns - before_ns),
        .level = level,
    };
    injector->has_edge = true;
    ++injector->edges;
    injector->guard.edges = (uint16_t)injector->edges;
}

/* Once the pulse is over: at its edge, the bus and the processor are left to who latches it. */
static void report_edge(injector_t *injector)
{
    uint8_t frames[INJECT_FRAMES_PER_EDGE][INJECT_FRAME_BYTES];
    if (!injector->has_edge) {
        return;
    }
    injector->has_edge = false;
    inject_frame_put_edge(&injector->edge, (uint8_t)injector->edge_counter, frames);
    injector->edge_counter = (uint16_t)(injector->edge_counter + INJECT_FRAMES_PER_EDGE);
    for (uint8_t i = 0u; i < INJECT_FRAMES_PER_EDGE; ++i) {
        report(injector, INJECT_ID_EDGE, frames[i]);
    }
}

/* ---- the line ---- */

/*
 * The kernel stamps no edge that it drives itself, so the clock is read on both sides. The earlier
 * reading is the edge: the way into the kernel is short, but before it returns, the edge may wake
 * others that run first.
 */
static void change_line(injector_t *injector)
{
    inject_train_t *train = &injector->train;
    uint8_t         level = inject_train_level(train);
    uint64_t        before_ns = clock_now_ns();
    bool            is_driven = injector_line_set(&injector->lines[train->shot.line], level != 0u);
    uint64_t        after_ns = clock_now_ns();

    if (!is_driven) {
        ++injector->failed_edges;
    } else if (inject_train_is_leading(train)) {
        note_edge(injector, level, before_ns, after_ns);
    }
    inject_train_advance(train, (uint32_t)(before_ns / CLOCK_NS_PER_US));
    if (inject_train_is_leading(train)) {
        report_edge(injector);
    }
    if (!inject_train_is_playing(train)) {
        injector->guard.is_running = false;
        report_status(injector, 0u, INJECT_OBEYED); /* the train is over */
    }
}

static void stop_train(injector_t *injector)
{
    inject_train_t *train = &injector->train;
    if (inject_train_is_playing(train) && !inject_train_is_leading(train)) {
        (void)injector_line_set(&injector->lines[train->shot.line], train->shot.level == 0u);
    }
    report_edge(injector);
    *train = (inject_train_t){.remaining = 0u};
    injector->guard.is_running = false;
}

/* ---- the loop ---- */

/* The kernel's generator gives so few bytes at once, and waits only while the computer starts. */
uint32_t injector_entropy(void)
{
    uint32_t number = 0u;
    while (getrandom(&number, sizeof number, 0u) != (ssize_t)sizeof number) {
    }
    return number;
}

static void obey(injector_t *injector, const uint8_t *frame, uint8_t length)
{
    inject_guard_stir(&injector->guard, injector_entropy());
    inject_order_t order = inject_guard_take(&injector->guard, frame, length, now_ms());
    if (order.has_stop) {
        stop_train(injector);
    }
    if (order.has_shot) {
        inject_train_begin(&injector->train, &order.shot, now_us());
        injector->guard.is_running = true;
    }
    report_status(injector, order.page, order.verdict);
}

/* An interface that is down may come up again; one that is gone will not. */
static bool take_command(injector_t *injector)
{
    can_received_t received;
    int            error = can_socket_receive(injector->can_fd, &received);
    if (error == 0 && (received.frame.can_id & CAN_ERR_FLAG) == 0u) {
        obey(injector, received.frame.data, received.frame.len);
    }
    return error != ENODEV && error != EBADF;
}

/* Microseconds that may be slept; false while there is nothing to wait for. */
static bool wait_us(const injector_t *injector, uint32_t *us)
{
    bool is_playing = inject_train_is_playing(&injector->train);
    *us = is_playing ? inject_train_wait_us(&injector->train, now_us()) : UINT32_MAX;
    if (injector->queue_count != 0u && *us > RETRY_SEND_US) {
        *us = RETRY_SEND_US;
    }
    return is_playing || injector->queue_count != 0u;
}

/* Sleep until a command comes or something is due. */
static bool has_command(const injector_t *injector, const sigset_t *sleeping)
{
    uint32_t        us;
    bool            has_end = wait_us(injector, &us);
    struct timespec timeout = {.tv_sec = us / 1000000u, .tv_nsec = (long)(us % 1000000u) * 1000};
    struct pollfd   poll = {.fd = injector->can_fd, .events = POLLIN};
    return ppoll(&poll, 1u, has_end ? &timeout : NULL, sleeping) > 0;
}

bool injector_serve(injector_t *injector, const volatile sig_atomic_t *is_ending,
                    const sigset_t *sleeping)
{
    bool is_served = true;
    while (is_served && *is_ending == 0) {
        if (has_command(injector, sleeping)) {
            is_served = take_command(injector);
        }
        if (inject_train_is_playing(&injector->train) &&
            inject_train_wait_us(&injector->train, now_us()) == 0u) {
            change_line(injector);
        }
        flush(injector);
    }
    stop_train(injector);
    flush(injector);
    if (!is_served) {
        say("the CAN interface is gone; see: ip -br link");
    }
    return is_served;
}
