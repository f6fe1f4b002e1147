/*
 * The trigger line: one line of a GPIO chip, by libgpiod v2. hal_edge.h arms it, with the kernel's
 * stamp as the captured time; without arming it is still requested as an input, so that its level
 * can be read (the PLC path).
 *
 * The chip may vanish at any time (a USB adapter pulled, gpio-sim switched off). Then levels stay
 * as they were, edge_is_lost() tells, and edge_recover() asks for the line anew. Edges that the
 * kernel still held at that moment are gone with the chip, and nobody can count them.
 */
#ifndef LINUX_EDGE_H
#define LINUX_EDGE_H

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    EDGE_BIAS_AS_IS,
    EDGE_BIAS_DISABLED,
    EDGE_BIAS_PULL_UP,
    EDGE_BIAS_PULL_DOWN
} edge_bias_t;

/*
 * The kernel stamps events on either clock; realtime stamps are brought to CLOCK_MONOTONIC when
 * they are read, so a step of the wall clock between edge and reading shows.
 */
typedef enum { EDGE_CLOCK_MONOTONIC, EDGE_CLOCK_REALTIME } edge_clock_t;

typedef struct {
    const char  *chip; /* path, name below /dev, or label; outlives the line */
    uint32_t     offset;
    edge_bias_t  bias;
    edge_clock_t event_clock;
    bool         active_low;  /* until hal_edge_arm() says otherwise, as is the next one */
    uint32_t     debounce_us; /* by the chip or else the kernel; an edge is stamped at its end */
    const char  *consumer;    /* what the kernel tells others who has the line */
} edge_line_t;

typedef struct {
    uint64_t edges;       /* handed to the firmware */
    uint64_t edges_lost;  /* the kernel's buffer ran over: gaps in its numbering. Edges that come
                             faster than its interrupt thread runs it merges into one, unseen. */
    uint64_t read_errors; /* of events and levels */
    uint64_t losses;      /* times the line vanished */
} edge_counters_t;

/* Request the line, disarmed. 0, or an errno after a line that says what to do. */
int edge_open(const edge_line_t *line);

void edge_close(void);

/* To be polled for reading; negative while there is no line. */
int edge_fd(void);

/* Take over the events that the kernel has; call it after the poll, as it would wait for one. */
void edge_fetch(void);

/* Hand the next fetched edge to hal_edge_on_latch(). False if there is none. */
bool edge_deliver(void);

/* The line has vanished. */
bool edge_is_lost(void);

/* Ask for the line again as it was, armed if it was. False as long as it cannot be had. */
bool edge_recover(void);

edge_counters_t edge_counters(void);

#endif
