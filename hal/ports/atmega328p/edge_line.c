#include "edge_line.h"

#include "board.h"
#include "hal_critical.h"
#include "hal_edge_events.h"
#include "hal_error.h"

edge_note_t       edge_line_notes[EDGE_LINE_NOTES];
volatile uint8_t  edge_line_noted;
volatile uint8_t  edge_line_delivered;
volatile uint16_t edge_line_lost;

static volatile bool is_low_active;

/* The firmware finds the position of the edge, as of a counter that captures. */
static void deliver(const edge_note_t *note)
{
    axis_hold_position(note->position_counts);
    hal_edge_on_latch(BOARD_TRIGGER_CHANNEL, clock_join_ticks(note->overflows, note->timer_ticks));
    axis_release_position();
}

bool edge_line_is_waiting(void)
{
    return edge_line_delivered != edge_line_noted;
}

void edge_line_deliver(void)
{
    while (edge_line_is_waiting()) {
        uint8_t here = edge_line_delivered;
        deliver(edge_line_at(here));
        edge_line_delivered = edge_line_after(here);
    }
}

int edge_line_check(const hal_edge_config_t *config)
{
    if (config->channel != BOARD_TRIGGER_CHANNEL) {
        return HAL_ERR_CHANNEL;
    }
    return config->glitch_filter_us == 0u ? HAL_OK : HAL_ERR_CONFIG;
}

void edge_line_clear(void)
{
    hal_critical_state_t saved = hal_critical_enter();
    edge_line_delivered = edge_line_noted;
    hal_critical_exit(saved);
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
