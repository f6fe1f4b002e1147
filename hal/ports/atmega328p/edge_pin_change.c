/*
 * The trigger line on a pin-change interrupt, for boards whose ICP1 is taken: the clock is read in
 * the interrupt, so that whatever masks it makes the stamp late, and a pulse that is over by then
 * is not seen.
 */
#include <avr/interrupt.h>

#include "board.h"
#include "disturbance.h"
#include "edge_line.h"
#include "hal_edge.h"
#include "hal_error.h"

ISR(PCINT0_vect)
{
    uint16_t seen = TCNT1;
    if (!edge_line_is_deflected()) {
        return;
    }
    if (disturbance_filters() && !disturbance_passes_filter(&seen)) {
        return;
    }
    edge_line_note(seen);
}

int hal_edge_arm(const hal_edge_config_t *config)
{
    int result = edge_line_check(config);
    if (result != HAL_OK) {
        return result;
    }
    PCICR &= (uint8_t)~_BV(PCIE0);
    edge_line_clear();
    edge_line_set_polarity(config->active_low);
    PCMSK0 |= _BV(PCINT0);
    PCIFR = _BV(PCIF0);
    PCICR |= _BV(PCIE0);
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel == BOARD_TRIGGER_CHANNEL) {
        PCICR &= (uint8_t)~_BV(PCIE0);
        edge_line_clear();
    }
}
