/* The ATmega2560 port under test. Time passes by Timer 4, which the port does not use. */
#include "contract/port_under_test.h"

#include <avr/io.h>

#include "../axis.h"
#include "../clock.h"
#include "tests/own_pins.h"

#define LINE _BV(PD4)

const port_facts_t PORT = OWN_FACTS(20u, 20u);

void own_start(uint32_t ticks)
{
    TIMSK1 = 0u;
    DDRD |= LINE;
    own_set_line(false);
    axis_start();
    axis_place(0);
    clock_start(ticks);
}

void own_set_line(bool high)
{
    if (high) {
        PORTD |= LINE;
    } else {
        PORTD &= (uint8_t)~LINE;
    }
}

void own_start_timer(void)
{
    TCCR4B = _BV(CS41);
}

uint8_t own_timer(void)
{
    return (uint8_t)TCNT4;
}

void own_place_axis(int32_t position_counts)
{
    axis_place(position_counts);
}
