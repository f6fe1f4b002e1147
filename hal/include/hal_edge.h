/*
 * The trigger line, as the port implements it and the firmware's task calls it.
 * Edges themselves arrive through hal_edge_events.h.
 */
#ifndef HAL_EDGE_H
#define HAL_EDGE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    uint8_t  channel;          /* board channel, from 0 */
    bool     active_low;       /* true: the line is low while the probe is deflected */
    uint16_t glitch_filter_us; /* pulses shorter than this are ignored; 0 switches the filter off */
} hal_edge_config_t;

/*
 * Watch the line: from now on each edge into the deflected state calls hal_edge_on_latch().
 * An edge from before the call must not be delivered. Arming again replaces the configuration.
 * Task. Returns HAL_OK, HAL_ERR_CHANNEL, or HAL_ERR_CONFIG if the filter cannot be had.
 */
int hal_edge_arm(const hal_edge_config_t *config);

/* Stop watching: no event is delivered after the return. Task. An unknown channel is ignored. */
void hal_edge_disarm(uint8_t channel);

/*
 * Level behind filter and polarity: true while deflected. Any context. An unknown channel reads
 * false.
 */
bool hal_edge_level(uint8_t channel);

#ifdef __cplusplus
}
#endif

#endif
