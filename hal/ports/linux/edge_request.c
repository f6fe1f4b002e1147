#include "edge_request.h"

#include <errno.h>

#define EVENTS_KERNEL 1024u /* the most the kernel gives */

static enum gpiod_line_bias bias_of(edge_bias_t bias)
{
    static const enum gpiod_line_bias BIASES[] = {
        [EDGE_BIAS_AS_IS] = GPIOD_LINE_BIAS_AS_IS,
        [EDGE_BIAS_DISABLED] = GPIOD_LINE_BIAS_DISABLED,
        [EDGE_BIAS_PULL_UP] = GPIOD_LINE_BIAS_PULL_UP,
        [EDGE_BIAS_PULL_DOWN] = GPIOD_LINE_BIAS_PULL_DOWN,
    };
    return BIASES[bias];
}

static int fill_settings(struct gpiod_line_settings *settings, const edge_line_t *line,
                         bool with_edges)
{
    int failed =
        gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT) |
        gpiod_line_settings_set_edge_detection(settings, with_edges ? GPIOD_LINE_EDGE_RISING
                                                                    : GPIOD_LINE_EDGE_NONE) |
        gpiod_line_settings_set_bias(settings, bias_of(line->bias)) |
        gpiod_line_settings_set_event_clock(settings, line->event_clock == EDGE_CLOCK_REALTIME
                                                          ? GPIOD_LINE_CLOCK_REALTIME
                                                          : GPIOD_LINE_CLOCK_MONOTONIC);
    gpiod_line_settings_set_active_low(settings, line->active_low);
    gpiod_line_settings_set_debounce_period_us(settings, line->debounce_us);
    return failed;
}

/* NULL when there is no memory. */
static struct gpiod_line_config *make_config(const edge_line_t *line, bool with_edges)
{
    struct gpiod_line_settings *settings = gpiod_line_settings_new();
    struct gpiod_line_config   *config = gpiod_line_config_new();
    bool is_whole = settings != NULL && config != NULL &&
                    fill_settings(settings, line, with_edges) == 0 &&
                    gpiod_line_config_add_line_settings(config, &line->offset, 1u, settings) == 0;
    gpiod_line_settings_free(settings);
    if (!is_whole) {
        gpiod_line_config_free(config);
        return NULL;
    }
    return config;
}

struct gpiod_line_request *edge_request_make(struct gpiod_chip *chip, const edge_line_t *line)
{
    struct gpiod_request_config *options = gpiod_request_config_new();
    struct gpiod_line_config    *config = make_config(line, false);
    struct gpiod_line_request   *made = NULL;
    errno = ENOMEM;
    if (options != NULL && config != NULL) {
        gpiod_request_config_set_consumer(options, line->consumer);
        gpiod_request_config_set_event_buffer_size(options, EVENTS_KERNEL);
        made = gpiod_chip_request_lines(chip, options, config);
    }
    int error = errno;
    gpiod_line_config_free(config);
    gpiod_request_config_free(options);
    errno = error;
    return made;
}

int edge_request_reconfigure(struct gpiod_line_request *request, const edge_line_t *line,
                             bool with_edges)
{
    struct gpiod_line_config *config = make_config(line, with_edges);
    int result = config != NULL ? gpiod_line_request_reconfigure_lines(request, config) : -1;
    gpiod_line_config_free(config);
    return result;
}
