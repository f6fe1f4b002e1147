/*
 * A line that the injector drives: an output line of a GPIO chip, or the pull of a line of
 * gpio-sim, which is an input to everybody else.
 */
#ifndef LINUX_INJECTOR_LINE_H
#define LINUX_INJECTOR_LINE_H

#include <stdbool.h>
#include <stdint.h>

struct gpiod_line_request;

/* One of the two is there. */
typedef struct {
    struct gpiod_line_request *output;  /* NULL: the pull */
    int                        pull_fd; /* -1: the output */
    uint32_t                   offset;
} injector_line_t;

/* Request an output line, named CHIP:OFFSET, at `level`. False after a line that says what to do.
 */
bool injector_line_open_output(injector_line_t *line, const char *name, bool level);

/* Take gpio-sim's file `pull` and pull to `level`. False after a line that says what to do. */
bool injector_line_open_pull(injector_line_t *line, const char *path, bool level);

/* Drive the line. False with errno set if that failed. */
bool injector_line_set(const injector_line_t *line, bool level);

void injector_line_close(injector_line_t *line);

#endif
