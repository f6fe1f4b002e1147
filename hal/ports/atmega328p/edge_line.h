/*
 * What both ways to watch the trigger line share: pin, polarity, and the way of an edge from its
 * interrupt to the firmware. edge_capture.c stamps the edge in hardware, edge_pin_change.c in the
 * interrupt; a program links one of the two.
 *
 * The interrupt only notes time and position and is over; the edge is delivered right after it
 * (deferred.h). So a train of edges is taken at a rate at which it could not be delivered.
 */
#ifndef ATMEGA328P_EDGE_LINE_H
#define ATMEGA328P_EDGE_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "axis.h"
#include "board.h"
#include "clock.h"
#include "hal_edge.h"

typedef struct {
    uint16_t timer_ticks;
    uint16_t overflows;
    int32_t  position_counts;
} edge_note_t;

#define EDGE_LINE_NOTES (256u / sizeof(edge_note_t)) /* one less can wait to be delivered */

/*
 * Notes from one place up to another, round the end, wait to be delivered. The places are counted
 * in bytes, 256 of them so that they wrap by themselves: that spares the interrupt a dozen cycles.
 * For edge_line_at() and edge_line_note() only.
 */
extern edge_note_t      edge_line_notes[EDGE_LINE_NOTES];
extern volatile uint8_t edge_line_noted;
extern volatile uint8_t edge_line_delivered;

/* Edges lost for want of room since the start; wraps. A rig reads it. */
extern volatile uint16_t edge_line_lost;

/* HAL_OK, HAL_ERR_CHANNEL, or HAL_ERR_CONFIG: this board has no filter. Task. */
int edge_line_check(const hal_edge_config_t *config);

/* Drop what waits to be delivered. Task, the interrupt of the line off. */
void edge_line_clear(void);

/* True: deflected while low. Task, the interrupt of the line off. */
void edge_line_set_polarity(bool active_low);

/* The pin behind the polarity. Any context. */
bool edge_line_is_deflected(void);

/* Whether there are edges to deliver, and deliver them. Deferred work. */
bool edge_line_is_waiting(void);
void edge_line_deliver(void);

/* The note at a place, and the place after it. */
static inline edge_note_t *edge_line_at(uint8_t place)
{
    return (edge_note_t *)(void *)((uint8_t *)edge_line_notes + place);
}

static inline uint8_t edge_line_after(uint8_t place)
{
    return (uint8_t)(place + sizeof(edge_note_t));
}

/* Have the edges delivered as soon as interrupts are on, by deferred.c. ISR. */
static inline void edge_line_ask(void)
{
    PIND = BOARD_DEFER_BIT; /* turns the pin over */
}

/*
 * An edge at this reading of Timer1. Inline, and without a call in it, for then the compiler saves
 * few registers. The interrupt of the line.
 */
static inline void edge_line_note(uint16_t timer_ticks)
{
    uint16_t overflows = clock_overflows_before(timer_ticks);
    uint8_t  here = edge_line_noted;
    uint8_t  next = edge_line_after(here);
    if (next == edge_line_delivered) {
        ++edge_line_lost;
        return;
    }
    edge_note_t *note = edge_line_at(here);
    note->timer_ticks = timer_ticks;
    note->overflows = overflows;
    note->position_counts = axis_position_masked();
    edge_line_noted = next;
    edge_line_ask();
}

#endif
