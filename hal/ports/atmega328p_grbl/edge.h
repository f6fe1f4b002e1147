/*
 * The probe's edges: the pin change interrupt notes the moment and is over, and the next step
 * interrupt delivers it, where grbl itself asks for the pin.
 */
#ifndef ATMEGA328P_GRBL_EDGE_H
#define ATMEGA328P_GRBL_EDGE_H

#include <stdint.h>

/* Edges lost for want of room since the start; wraps. A rig reads it. */
extern volatile uint16_t edge_line_lost;

#endif
