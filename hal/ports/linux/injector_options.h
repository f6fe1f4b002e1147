/* The command line of skiplatch-injector. */
#ifndef LINUX_INJECTOR_OPTIONS_H
#define LINUX_INJECTOR_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "inject/inject_frame.h"

#define INJECTOR_EXIT_USAGE 2

typedef struct {
    const char *name;    /* CHIP:OFFSET, or the path of a pull */
    bool        is_pull; /* of gpio-sim */
} injector_line_name_t;

typedef struct {
    const char          *interface;
    const char          *key_path;            /* NULL: commands need no seal */
    injector_line_name_t lines[INJECT_LINES]; /* line 0 of the protocol is the first given */
    uint8_t              line_count;
    bool                 rest;     /* level before the first pulse */
    bool                 has_help; /* the text was asked for */
    int                  cpu;      /* -1: any */
    int                  priority; /* of SCHED_FIFO; 0: usual scheduling */
} injector_options_t;

/* Read the command line. False after a line that says what is wrong. */
bool injector_options_parse(injector_options_t *options, int argc, char **argv);

void injector_options_print_help(void);

#endif
