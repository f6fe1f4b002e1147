/*
 * The ATmega2560 port under test, on the chip itself: it drives the trigger line from the pin's own
 * output, which the input capture sees as it sees a foreign one, and hears its own frames over a
 * wire from TXD 0 to RXD 0. Time passes by Timer 4, which the port does not use.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../axis.h"
#include "../bus.h"
#include "../clock.h"
#include "contract/port_under_test.h"

#define LINE          (1u << PD4)
#define HEARD_BYTES   1024u
#define COUNTS_PER_US 2u /* 16 MHz / 8 */

const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = true,
    .filter_max_us = 0u,
    .filter_tried_us = 50u,
    .edge_latency_us = 20u,
    .frame_latency_us = 2u * BUS_FRAME_US,
    .time_error_us = 20u,
};

static volatile uint8_t  heard[HEARD_BYTES];
static volatile uint16_t heard_count;
static uint16_t          taken_count;

ISR(USART0_RX_vect)
{
    uint8_t byte = UDR0;
    heard[heard_count % HEARD_BYTES] = byte;
    ++heard_count;
}

static uint16_t heard_bytes(void)
{
    uint8_t saved = SREG;
    cli();
    uint16_t count = heard_count;
    SREG = saved;
    return count;
}

void port_set_line(uint8_t channel, bool high)
{
    if (channel != 0u) {
        return;
    }
    if (high) {
        PORTD |= LINE;
    } else {
        PORTD &= (uint8_t)~LINE;
    }
}

/* Bytes on the wire come in before the count is set back. */
static void empty_bus(void)
{
    port_pass_us(BUS_FRAME_US);
    bus_start();
    port_pass_us(BUS_FRAME_US);
    UCSR0B |= 1u << RXCIE0;
    heard_count = 0u;
    taken_count = 0u;
}

bool port_power_up_at(uint32_t ticks)
{
    cli();
    TIMSK1 = 0u;
    TCCR4B = 1u << CS41;
    DDRD |= LINE;
    port_set_line(0u, false);
    axis_start();
    axis_place(0);
    sei();
    empty_bus();
    clock_start(ticks);
    return true;
}

void port_power_up(void)
{
    (void)port_power_up_at(0u);
}

void port_pass_us(uint32_t us)
{
    uint16_t last = TCNT4;
    uint32_t left = us * COUNTS_PER_US;
    while (left != 0u) {
        uint16_t now = TCNT4;
        uint16_t passed = (uint16_t)(now - last);
        left = passed < left ? left - passed : 0u;
        last = now;
    }
}

void port_place_axis(uint8_t axis, int32_t position_counts)
{
    if (axis == 0u) {
        axis_place(position_counts);
    }
}

bool port_receive(uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if ((uint16_t)(heard_bytes() - taken_count) < HAL_BUS_FRAME_BYTES) {
        return false;
    }
    for (uint8_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        frame[i] = heard[taken_count % HEARD_BYTES];
        ++taken_count;
    }
    return true;
}
