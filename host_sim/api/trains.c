#include "api/trains.h"

#include <stdbool.h>

#define REST_TICKS INT64_C(2147483648) /* half way round: beyond, before and after are alike */

int sim_trains_begin(sim_trains_t *trains, const transmission_config_t *config, uint32_t tick_ns)
{
    *trains = (sim_trains_t){.tick_ns = tick_ns, .last_ns = INT64_MIN, .dense_ns = INT64_MIN};
    if (tick_ns == 0u) {
        return SIM_TRAINS_ERR_TICK;
    }
    return transmission_init(&trains->core, config);
}

static int check(const sim_trains_t *trains, uint8_t channel, int64_t t_ns)
{
    uint8_t base = channel & (uint8_t)~TRANSMISSION_BACKWARD;
    if (base < TRANSMISSION_INPUT || base > TRANSMISSION_OUTPUT_INDEX) {
        return SIM_TRAINS_ERR_CHANNEL;
    }
    return t_ns < trains->last_ns ? SIM_TRAINS_ERR_ORDER : SIM_TRAINS_OK;
}

/* The denser train has rested for too long for the counter of ticks. */
static void notice_rest(sim_trains_t *trains, uint8_t channel, int64_t t_ns)
{
    if ((channel & (uint8_t)~TRANSMISSION_BACKWARD) != transmission_dense_channel(&trains->core)) {
        return;
    }
    if (trains->dense_ns != INT64_MIN &&
        (uint64_t)t_ns - (uint64_t)trains->dense_ns >= (uint64_t)REST_TICKS * trains->tick_ns) {
        transmission_pause(&trains->core);
    }
    trains->dense_ns = t_ns;
}

static sim_trains_point_t widened(sim_trains_t *trains, transmission_point_t point, int64_t t_ns,
                                  uint32_t ticks)
{
    int64_t ago_ns = (int64_t)(uint32_t)(ticks - point.ticks) * trains->tick_ns;
    trains->line += (int32_t)((uint32_t)point.line - (uint32_t)trains->line);
    return (sim_trains_point_t){
        .t_ns = t_ns - ago_ns, .line = trains->line, .delta_nas = point.delta_nas};
}

int sim_trains_feed(sim_trains_t *trains, const uint8_t *channels, const int64_t *t_ns, uint64_t n,
                    sim_trains_point_t *points, uint64_t *points_count)
{
    *points_count = 0u;
    for (uint64_t i = 0u; i < n; ++i) {
        int error = check(trains, channels[i], t_ns[i]);
        if (error != SIM_TRAINS_OK) {
            return error;
        }
        notice_rest(trains, channels[i], t_ns[i]);
        uint32_t ticks = (uint32_t)(uint64_t)(t_ns[i] / trains->tick_ns);
        uint8_t  found = transmission_on_pulse(&trains->core, channels[i], ticks);
        for (uint8_t k = 0u; k < found; ++k) {
            points[(*points_count)++] =
                widened(trains, transmission_point(&trains->core, k), t_ns[i], ticks);
        }
        trains->last_ns = t_ns[i];
        ++trains->pulses;
    }
    return SIM_TRAINS_OK;
}

pulse_counters_t sim_trains_counters(const sim_trains_t *trains, uint8_t channel)
{
    return transmission_counters(&trains->core, channel);
}

transmission_index_t sim_trains_index(const sim_trains_t *trains, uint8_t channel)
{
    return transmission_index(&trains->core, channel);
}
