#include "pulse.h"

#include <errno.h>
#include <gpiod.h>
#include <poll.h>

#include "chip.h"
#include "clock.h"
#include "hal_error.h"

#define EVENTS_READ 64u

static pulse_lines_t                   wanted;
static hal_pulse_edge_t                wanted_edge;
static struct gpiod_line_request      *request;
static struct gpiod_edge_event_buffer *events;
static size_t                          fetched;
static size_t                          taken;
static unsigned long                   last_number; /* of an event, as the kernel counts them */
static int                             error;

/* ---- the request ---- */

static struct gpiod_line_config *make_config(void)
{
    struct gpiod_line_settings *settings = gpiod_line_settings_new();
    struct gpiod_line_config   *config = gpiod_line_config_new();
    bool                        is_whole = settings != NULL && config != NULL;
    enum gpiod_line_edge        edge =
        wanted_edge == HAL_PULSE_RISING ? GPIOD_LINE_EDGE_RISING : GPIOD_LINE_EDGE_FALLING;
    if (is_whole) {
        is_whole = (gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT) |
                    gpiod_line_settings_set_edge_detection(settings, edge) |
                    gpiod_line_settings_set_event_clock(settings, GPIOD_LINE_CLOCK_MONOTONIC) |
                    gpiod_line_config_add_line_settings(config, wanted.offsets, HAL_PULSE_CHANNELS,
                                                        settings)) == 0;
    }
    gpiod_line_settings_free(settings);
    if (!is_whole) {
        gpiod_line_config_free(config);
        return NULL;
    }
    return config;
}

static struct gpiod_line_request *request_lines(struct gpiod_chip *chip)
{
    struct gpiod_request_config *options = gpiod_request_config_new();
    struct gpiod_line_config    *config = make_config();
    struct gpiod_line_request   *made = NULL;
    errno = ENOMEM;
    if (options != NULL && config != NULL) {
        gpiod_request_config_set_consumer(options, wanted.consumer);
        gpiod_request_config_set_event_buffer_size(options, PULSE_HELD);
        made = gpiod_chip_request_lines(chip, options, config);
    }
    int why = errno;
    gpiod_line_config_free(config);
    gpiod_request_config_free(options);
    errno = why;
    return made;
}

/* The line because of which both cannot be had, as far as can be seen. */
static uint32_t offset_at_fault(struct gpiod_chip *chip)
{
    for (unsigned i = 0u; i < HAL_PULSE_CHANNELS; ++i) {
        struct gpiod_line_info *info = gpiod_chip_get_line_info(chip, wanted.offsets[i]);
        bool                    is_free = info != NULL && !gpiod_line_info_is_used(info);
        gpiod_line_info_free(info);
        if (!is_free) {
            return wanted.offsets[i];
        }
    }
    return wanted.offsets[0];
}

/* Request what is wanted; with `aloud`, say why it cannot be had. */
static int open_wanted(bool aloud)
{
    struct gpiod_chip *chip = chip_open(wanted.chip);
    if (chip == NULL) {
        int why = errno;
        if (aloud) {
            chip_explain(wanted.chip, why);
        }
        return why;
    }
    request = request_lines(chip);
    int why = request != NULL ? 0 : errno;
    if (why != 0 && aloud) {
        chip_explain_line(chip, wanted.chip, offset_at_fault(chip), why);
    }
    gpiod_chip_close(chip);
    return why;
}

int pulse_open(const pulse_lines_t *lines)
{
    hal_pulse_stop();
    wanted = *lines;
    int why = open_wanted(true);
    hal_pulse_stop();
    return why;
}

int pulse_fd(void)
{
    return request == NULL || error != 0 ? -1 : gpiod_line_request_get_fd(request);
}

int pulse_error(void)
{
    return error;
}

/* ---- events ---- */

static bool is_readable(void)
{
    struct pollfd watch = {.fd = pulse_fd(), .events = POLLIN};
    return watch.fd >= 0 && poll(&watch, 1u, 0) == 1;
}

static void fetch(void)
{
    int count = gpiod_line_request_read_edge_events(request, events, EVENTS_READ);
    if (count < 0) {
        error = errno;
        return;
    }
    taken = 0u;
    fetched = (size_t)count;
}

/* The kernel numbers the events of the lines together, from 1 on. */
static uint8_t lost_before(unsigned long number)
{
    unsigned long lost = number - last_number - 1u;
    last_number = number;
    return lost < UINT8_MAX ? (uint8_t)lost : UINT8_MAX;
}

bool hal_pulse_take(hal_pulse_t *pulse)
{
    if (taken == fetched && is_readable()) {
        fetch();
    }
    if (taken == fetched) {
        return false;
    }
    struct gpiod_edge_event *event = gpiod_edge_event_buffer_get_event(events, taken);
    ++taken;
    pulse->captured_ticks = clock_ticks_of_ns(gpiod_edge_event_get_timestamp_ns(event));
    pulse->channel = gpiod_edge_event_get_line_offset(event) == wanted.offsets[1];
    pulse->lost = lost_before(gpiod_edge_event_get_global_seqno(event));
    return true;
}

/* ---- starting and stopping: what the kernel keeps goes with the request ---- */

int hal_pulse_start(hal_pulse_edge_t edge)
{
    hal_pulse_stop();
    wanted_edge = edge;
    events = gpiod_edge_event_buffer_new(EVENTS_READ);
    if (events == NULL || wanted.chip == NULL || open_wanted(false) != 0) {
        return HAL_ERR_CONFIG;
    }
    return HAL_OK;
}

void hal_pulse_stop(void)
{
    if (request != NULL) {
        gpiod_line_request_release(request);
    }
    gpiod_edge_event_buffer_free(events);
    request = NULL;
    events = NULL;
    fetched = 0u;
    taken = 0u;
    last_number = 0u;
    error = 0;
}
