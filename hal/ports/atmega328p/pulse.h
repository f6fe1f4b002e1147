/* What the pulse inputs keep; see pulse.c. A rig reads it to know the stamps. */
#ifndef ATMEGA328P_PULSE_H
#define ATMEGA328P_PULSE_H

#include <stdint.h>

typedef struct {
    uint16_t timer_ticks;
    uint16_t overflows;
    uint8_t  channel;
    uint8_t  lost;
} pulse_note_t;

#define PULSE_NOTES 128u /* a power of two, at most 128 */

extern volatile pulse_note_t pulse_notes[PULSE_NOTES];
extern volatile uint8_t      pulse_noted; /* since the start, modulo 256 */

#endif
