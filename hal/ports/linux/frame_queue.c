#include "frame_queue.h"

#include <assert.h>
#include <string.h>

bool frame_queue_push(frame_queue_t *queue, const uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if (queue->count == FRAME_QUEUE_LENGTH) {
        return false;
    }
    size_t end = (queue->first + queue->count) % FRAME_QUEUE_LENGTH;
    memcpy(queue->frames[end], frame, HAL_BUS_FRAME_BYTES);
    ++queue->count;
    return true;
}

const uint8_t *frame_queue_first(const frame_queue_t *queue)
{
    return queue->count == 0u ? NULL : queue->frames[queue->first];
}

void frame_queue_pop(frame_queue_t *queue)
{
    assert(queue->count > 0u);
    queue->first = (queue->first + 1u) % FRAME_QUEUE_LENGTH;
    --queue->count;
}
