/* A queue of frames that wait for the bus: first in, first out, of fixed size. */
#ifndef LINUX_FRAME_QUEUE_H
#define LINUX_FRAME_QUEUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal_bus.h"

#define FRAME_QUEUE_LENGTH 256u /* 128 latch records */

/* Start from all zeros. */
typedef struct {
    uint8_t frames[FRAME_QUEUE_LENGTH][HAL_BUS_FRAME_BYTES];
    size_t  first;
    size_t  count;
} frame_queue_t;

/* Copy `frame` to the end. False, and nothing happens, when there is no room. */
bool frame_queue_push(frame_queue_t *queue, const uint8_t frame[HAL_BUS_FRAME_BYTES]);

/* The first frame, which stays in the queue; NULL if there is none. */
const uint8_t *frame_queue_first(const frame_queue_t *queue);

/* Drop the first frame; there has to be one. */
void frame_queue_pop(frame_queue_t *queue);

#endif
