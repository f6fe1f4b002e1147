#include "input/skip_input.h"

#include "hal_axis.h"
#include "hal_error.h"

int skip_input_start(skip_input_t *input, const skip_input_config_t *config)
{
    if (config->edge.channel > LATCH_CHANNEL_MAX) {
        return HAL_ERR_CHANNEL;
    }
    /* The latch is whole before the first edge can come. */
    latch_init(&input->latch, config->edge.channel, 0u);
    input->channel = config->edge.channel;
    input->axis = config->axis;
    int error = hal_edge_arm(&config->edge);
    /* A cycle may begin before a poll. To a latch that is disarmed the time is nothing. */
    if (error == HAL_OK) {
        skip_input_poll(input, 0u);
    }
    return error;
}

void skip_input_stop(skip_input_t *input)
{
    hal_edge_disarm(input->channel);
    latch_disarm(&input->latch);
}

void skip_input_on_edge(skip_input_t *input, uint32_t captured_ticks)
{
    latch_on_edge(&input->latch, captured_ticks, hal_axis_position_counts(input->axis));
}

void skip_input_poll(skip_input_t *input, uint32_t now_ticks)
{
    latch_poll(&input->latch, now_ticks, hal_edge_level(input->channel));
}
