/*
 * Report stage: frames on their way from the controller to the recorder. Frames sent at one instant
 * travel as one burst: latency + U(0, jitter) (step 6 of the nominal chain). Bursts do not
 * overtake.
 */
#ifndef SIM_BUS_H
#define SIM_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal_bus.h"
#include "sim_time.h"

#define SIM_BUS_FRAMES 8u /* a power of two */

typedef struct {
    uint8_t  frames[SIM_BUS_FRAMES][HAL_BUS_FRAME_BYTES];
    sim_ns_t arrivals[SIM_BUS_FRAMES];
    uint32_t sent; /* frames, since the start */
    uint32_t taken;
    sim_ns_t burst_sent;    /* when the newest burst left */
    sim_ns_t burst_arrival; /* and when it arrives */
} sim_bus_t;

void sim_bus_reset(sim_bus_t *bus);

bool sim_bus_is_full(const sim_bus_t *bus);

/* True if a frame sent now begins a burst, whose travel time has to be given. */
bool sim_bus_begins_burst(const sim_bus_t *bus, sim_ns_t now);

/* Send one frame; `travel` counts only for the first of a burst. The bus must not be full. */
void sim_bus_send(sim_bus_t *bus, const uint8_t *frame, sim_ns_t travel, sim_ns_t now);

/* When the next frame arrives, or SIM_NEVER. */
sim_ns_t sim_bus_arrival(const sim_bus_t *bus);

/* Take the next frame: HAL_BUS_FRAME_BYTES, valid until the next send. One must be under way. */
const uint8_t *sim_bus_take(sim_bus_t *bus);

#endif
