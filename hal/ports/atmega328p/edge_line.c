#include "edge_line.h"

#include "board.h"
#include "hal_error.h"

static volatile bool is_low_active;

int edge_line_check(const hal_edge_config_t *config)
{
    if (config->channel != BOARD_TRIGGER_CHANNEL) {
        return HAL_ERR_CHANNEL;
    }
    return config->glitch_filter_us == 0u ? HAL_OK : HAL_ERR_CONFIG;
}

void edge_line_set_polarity(bool active_low)
{
    is_low_active = active_low;
}

bool edge_line_is_deflected(void)
{
    return ((PINB & BOARD_TRIGGER_BIT) != 0u) != is_low_active;
}

bool hal_edge_level(uint8_t channel)
{
    return channel == BOARD_TRIGGER_CHANNEL && edge_line_is_deflected();
}
