#include "bus.h"

#include <string.h>

#define SLOT(number) ((number) % SIM_BUS_FRAMES)

void sim_bus_reset(sim_bus_t *bus)
{
    bus->sent = 0u;
    bus->taken = 0u;
    bus->burst_sent = -1;
    bus->burst_arrival = 0;
}

bool sim_bus_is_full(const sim_bus_t *bus)
{
    return bus->sent - bus->taken == SIM_BUS_FRAMES;
}

bool sim_bus_begins_burst(const sim_bus_t *bus, sim_ns_t now)
{
    return bus->burst_sent != now;
}

void sim_bus_send(sim_bus_t *bus, const uint8_t *frame, sim_ns_t travel, sim_ns_t now)
{
    if (sim_bus_begins_burst(bus, now)) {
        sim_ns_t arrival = now + travel;
        bus->burst_sent = now;
        bus->burst_arrival = arrival > bus->burst_arrival ? arrival : bus->burst_arrival;
    }
    memcpy(bus->frames[SLOT(bus->sent)], frame, HAL_BUS_FRAME_BYTES);
    bus->arrivals[SLOT(bus->sent)] = bus->burst_arrival;
    ++bus->sent;
}

sim_ns_t sim_bus_arrival(const sim_bus_t *bus)
{
    return bus->sent == bus->taken ? SIM_NEVER : bus->arrivals[SLOT(bus->taken)];
}

const uint8_t *sim_bus_take(sim_bus_t *bus)
{
    const uint8_t *frame = bus->frames[SLOT(bus->taken)];
    ++bus->taken;
    return frame;
}
