/* The port with grbl's pins under test. Time passes by Timer 2. An edge waits for the next tick. */
#include "contract/port_under_test.h"

#include <avr/io.h>

#include "../board.h"
#include "../stepper.h"
#include "hal_edge.h"
#include "tests/own_pins.h"

const port_facts_t PORT = OWN_FACTS(2600u, 30u);

void own_start(uint32_t ticks)
{
    hal_edge_disarm(BOARD_PROBE_CHANNEL);
    DDRC |= BOARD_PROBE_BIT;
    own_set_line(false);
    stepper_start(ticks);
}

void own_set_line(bool high)
{
    if (high) {
        PORTC |= BOARD_PROBE_BIT;
    } else {
        PORTC &= (uint8_t)~BOARD_PROBE_BIT;
    }
}

void own_start_timer(void)
{
    TCCR2B = _BV(CS21);
}

uint8_t own_timer(void)
{
    return TCNT2;
}

void own_place_axis(int32_t position_counts)
{
    stepper_place(position_counts);
}
