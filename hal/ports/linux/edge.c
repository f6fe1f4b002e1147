#include "edge.h"

#include <errno.h>
#include <gpiod.h>
#include <poll.h>

#include "axis.h"
#include "chip.h"
#include "clock.h"
#include "edge_request.h"
#include "hal_edge.h"
#include "hal_edge_events.h"
#include "hal_error.h"

#define CHANNEL     0u
#define EVENTS_READ 64u

static edge_line_t                     wanted; /* how the line is, or will be once it is back */
static bool                            is_armed;
static struct gpiod_line_request      *request;
static struct gpiod_edge_event_buffer *events;
static size_t                          fetched;
static size_t                          delivered;
static unsigned long                   last_number; /* of an event, as the kernel counts them */
static bool                            level;
static bool                            is_lost;
static edge_counters_t                 counted;

static void note_read_error(void)
{
    ++counted.read_errors;
    if (!is_lost) {
        ++counted.losses;
    }
    is_lost = true;
}

/* ---- the request ---- */

static int reconfigure(bool with_edges)
{
    return request == NULL ? -1 : edge_request_reconfigure(request, &wanted, with_edges);
}

/* Request what is wanted, disarmed; with `aloud`, say why it cannot be had. */
static int open_wanted(bool aloud)
{
    struct gpiod_chip *chip = chip_open(wanted.chip);
    if (chip == NULL) {
        int error = errno;
        if (aloud) {
            chip_explain(wanted.chip, error);
        }
        return error;
    }
    request = edge_request_make(chip, &wanted);
    int error = request != NULL ? 0 : errno;
    if (error != 0 && aloud) {
        chip_explain_line(chip, wanted.chip, wanted.offset, error);
    }
    gpiod_chip_close(chip);
    last_number = 0u;
    return error;
}

int edge_open(const edge_line_t *line)
{
    edge_close();
    counted = (edge_counters_t){0};
    wanted = *line;
    events = gpiod_edge_event_buffer_new(EVENTS_READ);
    return events == NULL ? ENOMEM : open_wanted(true);
}

static void drop_fetched(void)
{
    fetched = 0u;
    delivered = 0u;
}

static void release(void)
{
    if (request != NULL) {
        gpiod_line_request_release(request);
    }
    request = NULL;
    drop_fetched();
}

void edge_close(void)
{
    release();
    gpiod_edge_event_buffer_free(events);
    events = NULL;
    is_armed = false;
    is_lost = false;
    level = false;
}

int edge_fd(void)
{
    return request == NULL || is_lost ? -1 : gpiod_line_request_get_fd(request);
}

bool edge_is_lost(void)
{
    return is_lost;
}

bool edge_recover(void)
{
    release();
    if (open_wanted(false) != 0) {
        return false;
    }
    if (is_armed && reconfigure(true) != 0) {
        release();
        return false;
    }
    is_lost = false;
    return true;
}

edge_counters_t edge_counters(void)
{
    return counted;
}

/* ---- events ---- */

static bool is_readable(void)
{
    struct pollfd watch = {.fd = edge_fd(), .events = POLLIN};
    return watch.fd >= 0 && poll(&watch, 1u, 0) == 1;
}

/* The kernel numbers the events of a line from 1 on and throws the oldest away. */
static void count_gap(struct gpiod_edge_event *event)
{
    unsigned long number = gpiod_edge_event_get_line_seqno(event);
    if (number > last_number + 1u) {
        counted.edges_lost += number - last_number - 1u;
    }
    last_number = number;
}

static void read_events(void)
{
    drop_fetched();
    int count = gpiod_line_request_read_edge_events(request, events, EVENTS_READ);
    if (count < 0) {
        note_read_error();
        return;
    }
    fetched = (size_t)count;
    for (size_t i = 0u; i < fetched; ++i) {
        count_gap(gpiod_edge_event_buffer_get_event(events, i));
    }
}

void edge_fetch(void)
{
    if (request != NULL && delivered == fetched) {
        read_events();
    }
}

static uint64_t stamp_ns(struct gpiod_edge_event *event)
{
    uint64_t stamp = gpiod_edge_event_get_timestamp_ns(event);
    return wanted.event_clock == EDGE_CLOCK_REALTIME ? clock_monotonic_of_realtime_ns(stamp)
                                                     : stamp;
}

bool edge_deliver(void)
{
    if (delivered == fetched) {
        return false;
    }
    uint64_t at_ns = stamp_ns(gpiod_edge_event_buffer_get_event(events, delivered));
    ++delivered;
    ++counted.edges;
    axis_capture(at_ns);
    hal_edge_on_latch(CHANNEL, clock_ticks_of_ns(at_ns));
    axis_follow();
    return true;
}

/* ---- hal_edge.h ---- */

/* What the kernel has already stamped would otherwise come up later. */
static void drop_events(void)
{
    drop_fetched();
    while (is_readable() && !is_lost) {
        read_events();
    }
    drop_fetched();
}

static int stop_edges(void)
{
    is_armed = false;
    int result = reconfigure(false);
    drop_events();
    return result;
}

int hal_edge_arm(const hal_edge_config_t *config)
{
    if (config->channel != CHANNEL) {
        return HAL_ERR_CHANNEL;
    }
    wanted.active_low = config->active_low;
    wanted.debounce_us = config->glitch_filter_us;
    if (stop_edges() != 0 || reconfigure(true) != 0) {
        return HAL_ERR_CONFIG;
    }
    is_armed = true;
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel == CHANNEL) {
        (void)stop_edges(); /* a line that has vanished delivers nothing either */
    }
}

bool hal_edge_level(uint8_t channel)
{
    if (channel != CHANNEL) {
        return false;
    }
    if (request != NULL && !is_lost) {
        enum gpiod_line_value value = gpiod_line_request_get_value(request, wanted.offset);
        if (value == GPIOD_LINE_VALUE_ERROR) {
            note_read_error();
        } else {
            level = value == GPIOD_LINE_VALUE_ACTIVE;
        }
    }
    return level;
}
