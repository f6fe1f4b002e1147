/* The command line of skiplatch-controller. */
#ifndef LINUX_OPTIONS_H
#define LINUX_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "edge.h"

typedef struct {
    edge_line_t line;
    const char *can;
    uint32_t    latch_id;
    bool        is_plc;
    uint32_t    scan_us;
    double      feed_mm_min;
    double      resolution_um;
    int         cpu;           /* −1 for any */
    int         fifo_priority; /* 0 for none */
    bool        lock_memory;
    uint64_t    touches; /* 0 for no end */
} options_t;

typedef enum { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_BAD } options_result_t;

/*
 * Read the command line; the texts of `options` point into it. OPTIONS_BAD comes after one line
 * that says what is wrong; OPTIONS_HELP after the usage.
 */
options_result_t options_parse(int argc, char **argv, options_t *options);

#endif
