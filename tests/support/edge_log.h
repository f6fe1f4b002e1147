/* Implements hal_edge_on_latch() for tests: remembers what the port has delivered. */
#ifndef SUPPORT_EDGE_LOG_H
#define SUPPORT_EDGE_LOG_H

#include <stdint.h>

#define EDGE_LOG_MAX 64u

typedef struct {
    uint32_t captured_ticks;
    uint32_t now_ticks;       /* the clock when the interrupt ran */
    int32_t  position_counts; /* of axis 0 when it ran */
    uint8_t  channel;
} edge_log_entry_t;

void edge_log_clear(void);

/* Edges since then. */
unsigned edge_log_count(void);

/* One of them, from 0, below EDGE_LOG_MAX. */
const edge_log_entry_t *edge_log_entry(unsigned number);

#endif
