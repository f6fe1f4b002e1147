/*
 * What a board with an ATmega adds to the port under test, beside its facts: the line is driven by
 * the pin's own output, which the chip sees as it sees a foreign one, and a timer that the port
 * does not use tells the time.
 */
#ifndef ATMEGA_OWN_PINS_H
#define ATMEGA_OWN_PINS_H

#include <stdbool.h>
#include <stdint.h>

#include "uart_bus.h"

/*
 * The facts of such a board: from the line to the delivery of an edge it takes so long at most.
 * Time is waited for in a loop, and interrupts come in between.
 */
#define OWN_FACTS(edge_latency, time_error)                         \
    {                                                               \
        .channels = 1u,                                             \
        .axes = 1u,                                                 \
        .has_active_low = true,                                     \
        .filter_max_us = 0u,                                        \
        .filter_tried_us = 50u,                                     \
        .edge_latency_us = (edge_latency),                          \
        .frame_latency_us = 2u * HAL_BUS_FRAME_BYTES * BUS_BYTE_US, \
        .time_error_us = (time_error),                              \
    }

/* All but the bus as after power-on, the line low, the clock at `ticks`. Interrupts masked. */
void own_start(uint32_t ticks);

/* Drive the trigger line. Task. */
void own_set_line(bool high);

/* Counts up twice a µs, from own_start_timer() on, and wraps at 256. */
void    own_start_timer(void);
uint8_t own_timer(void);

/* Put the axis of the board somewhere, at rest. Task. */
void own_place_axis(int32_t position_counts);

#endif
