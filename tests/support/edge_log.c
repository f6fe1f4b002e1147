#include "edge_log.h"

#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_edge_events.h"

static edge_log_entry_t  entries[EDGE_LOG_MAX];
static volatile unsigned count;

void edge_log_clear(void)
{
    count = 0u;
}

unsigned edge_log_count(void)
{
    return count;
}

const edge_log_entry_t *edge_log_entry(unsigned number)
{
    return &entries[number % EDGE_LOG_MAX];
}

void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    entries[count % EDGE_LOG_MAX] = (edge_log_entry_t){
        .captured_ticks = captured_ticks,
        .now_ticks = hal_clock_now_ticks(),
        .position_counts = hal_axis_position_counts(0u),
        .channel = channel,
    };
    ++count;
}
