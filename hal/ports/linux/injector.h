/* The injector: obeys the commands of the injection protocol on its lines. */
#ifndef LINUX_INJECTOR_H
#define LINUX_INJECTOR_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "inject/inject_frame.h"
#include "inject/inject_guard.h"
#include "inject/inject_train.h"
#include "injector_line.h"

#define INJECTOR_QUEUE_LENGTH 512u /* 256 edge reports */

typedef struct {
    uint16_t id;
    uint8_t  bytes[INJECT_FRAME_BYTES];
} injector_report_t;

typedef struct {
    injector_line_t   lines[INJECT_LINES];
    inject_guard_t    guard;
    inject_train_t    train;
    injector_report_t queue[INJECTOR_QUEUE_LENGTH]; /* reports that the bus did not yet take */
    uint32_t          queue_first;
    uint32_t          queue_count;
    inject_edge_t     edge;           /* the leading one of the pulse that plays */
    bool              has_edge;       /* and it has not been reported */
    uint32_t          edges;          /* leading ones */
    uint32_t          failed_edges;   /* the line could not be driven */
    uint16_t          status_counter; /* of the next status frame */
    uint16_t          edge_counter;   /* of the next edge frame */
    int               can_fd;
} injector_t;

/* A number that nobody can foretell, from the kernel. */
uint32_t injector_entropy(void);

/*
 * Serve until `is_ending` is set by a signal, or the bus is gone (then false, after a line that
 * says so). `sleeping` is the signal mask while nothing is to be done. The line is left at rest.
 */
bool injector_serve(injector_t *injector, const volatile sig_atomic_t *is_ending,
                    const sigset_t *sleeping);

#endif
