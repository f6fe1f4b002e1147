/*
 * The skip input: an edge interrupt latches the captured time and the axis position.
 * The latch error is the interrupt's latency, whatever the task is doing.
 */
#ifndef INPUT_SKIP_INPUT_H
#define INPUT_SKIP_INPUT_H

#include <stdint.h>

#include "hal_edge.h"
#include "input/latch.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    hal_edge_config_t edge; /* line, polarity, glitch filter */
    uint8_t           axis; /* whose position is latched */
} skip_input_config_t;

/*
 * Owned by the caller. `latch` is public: arm it and take records from it with the latch_
 * functions.
 */
typedef struct {
    latch_t latch;
    uint8_t channel;
    uint8_t axis;
} skip_input_t;

/*
 * Watch the line, disarmed. Task. Returns HAL_OK or the error of hal_edge_arm(), or
 * HAL_ERR_CHANNEL.
 */
int skip_input_start(skip_input_t *input, const skip_input_config_t *config);

/* Watch the line no longer. Task. */
void skip_input_stop(skip_input_t *input);

/* Hand over an edge from hal_edge_on_latch(). ISR. */
void skip_input_on_edge(skip_input_t *input, uint32_t captured_ticks);

/* Read the level and let the latch judge; see latch_poll(). Task. */
void skip_input_poll(skip_input_t *input, uint32_t now_ticks);

#ifdef __cplusplus
}
#endif

#endif
