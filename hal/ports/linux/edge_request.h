/* What the trigger line is asked for with, in libgpiod's terms. Only edge.c uses it. */
#ifndef LINUX_EDGE_REQUEST_H
#define LINUX_EDGE_REQUEST_H

#include <gpiod.h>
#include <stdbool.h>

#include "edge.h"

/* Request the line, without edges. NULL with errno set if it cannot be had. */
struct gpiod_line_request *edge_request_make(struct gpiod_chip *chip, const edge_line_t *line);

/* Ask for what the line is now to be, with or without edges. Negative if it cannot be so. */
int edge_request_reconfigure(struct gpiod_line_request *request, const edge_line_t *line,
                             bool with_edges);

#endif
