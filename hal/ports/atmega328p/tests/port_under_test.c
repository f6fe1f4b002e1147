/* The ATmega328P port under test. Time passes by Timer 2, whose scans are not started here. */
#include "contract/port_under_test.h"

#include <avr/io.h>

#include "../axis.h"
#include "../board.h"
#include "../clock.h"
#include "../deferred.h"
#include "../scan.h"
#include "hal_edge.h"
#include "tests/own_pins.h"

const port_facts_t PORT = OWN_FACTS(40u, 20u);

/* No scans here. */
void scan_on_time(void)
{
}

void own_start(uint32_t ticks)
{
    hal_edge_disarm(BOARD_TRIGGER_CHANNEL);
    DDRB |= BOARD_TRIGGER_BIT;
    own_set_line(false);
    clock_start();
    deferred_start();
    axis_start();
    axis_place(0);
    clock_set_ticks(ticks);
}

void own_set_line(bool high)
{
    if (high) {
        PORTB |= BOARD_TRIGGER_BIT;
    } else {
        PORTB &= (uint8_t)~BOARD_TRIGGER_BIT;
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
    axis_place(position_counts);
}
