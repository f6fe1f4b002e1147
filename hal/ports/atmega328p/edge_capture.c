/*
 * The trigger line on the input capture of Timer1: the hardware keeps the timer at the edge, so
 * that the stamp is exact however late the interrupt comes, up to half a turn of the timer. A
 * second edge before it has read the first takes the first one's place.
 */
#include <avr/interrupt.h>

#include "board.h"
#include "disturbance.h"
#include "edge_line.h"
#include "hal_edge.h"
#include "hal_error.h"

ISR(TIMER1_CAPT_vect)
{
    uint16_t captured = ICR1;
    if (disturbance_filters() && !disturbance_passes_filter(&captured)) {
        return;
    }
    edge_line_note(captured);
}

static void set_edge(bool active_low)
{
    if (active_low) {
        TCCR1B &= (uint8_t)~_BV(ICES1);
    } else {
        TCCR1B |= _BV(ICES1);
    }
}

/* The flag goes last: choosing the other edge may raise it. */
int hal_edge_arm(const hal_edge_config_t *config)
{
    int result = edge_line_check(config);
    if (result != HAL_OK) {
        return result;
    }
    TIMSK1 &= (uint8_t)~_BV(ICIE1);
    edge_line_clear();
    edge_line_set_polarity(config->active_low);
    set_edge(config->active_low);
    TIFR1 = _BV(ICF1);
    TIMSK1 |= _BV(ICIE1);
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel == BOARD_TRIGGER_CHANNEL) {
        TIMSK1 &= (uint8_t)~_BV(ICIE1);
        edge_line_clear();
    }
}
