/*
 * The two pulse inputs of the program main_transmission.c. Timer1 has one capture unit, and the
 * second train has to be stamped another way:
 *
 *   channel 1, the output encoder, ICP1 (PB0): the hardware keeps the timer at the edge; exact to
 *     the cycle however late the interrupt comes, up to half a turn of the timer
 *   channel 0, the input encoder, INT0 (PD2): the most urgent interrupt, which reads the timer. A
 *     stamp is late by the rest of the instruction that runs, up to four cycles, or of the
 *     interrupt that runs: docs/TRANSMISSION.md has the figures
 *
 * Switching the capture unit to and fro between two pins (by ACIC, the comparator's) would stamp
 * both by hardware and miss what comes on the other one meanwhile: a lost line is worth more than a
 * few cycles. ICP1 goes to the train that usually gates: its stamp stands in a point alone, those
 * of the other train in part.
 *
 * Neither unit tells of an edge that came before the one before was seen to: the edges of a line
 * have to be further apart than the interrupts take, or the judge of comp/ has to find it.
 */
#include <avr/interrupt.h>

#include "board.h"
#include "clock.h"
#include "hal_error.h"
#include "hal_pulse.h"
#include "pulse.h"

/* From the edge to the reading of the timer if nothing is in the way: four to enter the interrupt,
 * three to jump, and the prologue. */
#define ENTRY_CYCLES 33u
#define ENTRY_TICKS  (ENTRY_CYCLES / CLOCK_PRESCALER)

volatile pulse_note_t   pulse_notes[PULSE_NOTES];
volatile uint8_t        pulse_noted;
static volatile uint8_t taken;
static uint8_t          lost; /* since the last one that was noted; interrupts only */

/*
 * Where there was no room, all are dropped until the task has caught up: it then gets as many in a
 * row as there is room for, and not one between two gaps. In line, and without a call in it, for
 * then the compiler saves few registers.
 */
__attribute__((always_inline)) static inline void note(uint8_t channel, uint16_t timer_ticks)
{
    uint16_t overflows = clock_overflows_before(timer_ticks);
    uint8_t  here = pulse_noted;
    if ((uint8_t)(here - taken) == PULSE_NOTES || (lost != 0u && here != taken)) {
        if (lost != UINT8_MAX) {
            ++lost;
        }
        return;
    }
    volatile pulse_note_t *place = &pulse_notes[here % PULSE_NOTES];
    place->timer_ticks = timer_ticks;
    place->overflows = overflows;
    place->channel = channel;
    place->lost = lost;
    lost = 0u;
    pulse_noted = (uint8_t)(here + 1u);
}

ISR(INT0_vect)
{
    uint16_t seen = TCNT1;
    note(0u, (uint16_t)(seen - ENTRY_TICKS));
}

ISR(TIMER1_CAPT_vect)
{
    note(1u, ICR1);
}

static void choose(hal_pulse_edge_t edge)
{
    EICRA |= _BV(ISC01);
    if (edge == HAL_PULSE_RISING) {
        EICRA |= _BV(ISC00);
        TCCR1B |= _BV(ICES1);
    } else {
        EICRA &= (uint8_t)~_BV(ISC00);
        TCCR1B &= (uint8_t)~_BV(ICES1);
    }
}

/* The flags go last: choosing an edge may raise them. */
int hal_pulse_start(hal_pulse_edge_t edge)
{
    hal_pulse_stop();
    lost = 0u;
    choose(edge);
    EIFR = _BV(INTF0);
    TIFR1 = _BV(ICF1);
    EIMSK |= _BV(INT0);
    TIMSK1 |= _BV(ICIE1);
    return HAL_OK;
}

void hal_pulse_stop(void)
{
    EIMSK &= (uint8_t)~_BV(INT0);
    TIMSK1 &= (uint8_t)~_BV(ICIE1);
    taken = pulse_noted;
}

bool hal_pulse_take(hal_pulse_t *pulse)
{
    uint8_t here = taken;
    if (here == pulse_noted) {
        return false;
    }
    const volatile pulse_note_t *place = &pulse_notes[here % PULSE_NOTES];
    pulse->captured_ticks = clock_join_ticks(place->overflows, place->timer_ticks);
    pulse->channel = place->channel;
    pulse->lost = place->lost;
    taken = (uint8_t)(here + 1u);
    return true;
}
