/*
 * The ATmega328P port under test, on the chip itself: it drives the trigger line from the pin's own
 * output, which the input capture sees as it sees a foreign one, and hears its own frames over a
 * wire from TXD to RXD. Time passes by Timer 2, whose scans are not started here.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../axis.h"
#include "../board.h"
#include "../bus.h"
#include "../clock.h"
#include "../deferred.h"
#include "../scan.h"
#include "contract/port_under_test.h"
#include "hal_edge.h"

#define HEARD_BYTES   256u
#define COUNTS_PER_US 2u /* 16 MHz / 8 */
#define FRAME_US      (HAL_BUS_FRAME_BYTES * BUS_BYTE_US)

/* Time is waited for in a loop, and interrupts come in between. */
const port_facts_t PORT = {
    .channels = 1u,
    .axes = 1u,
    .has_active_low = true,
    .filter_max_us = 0u,
    .filter_tried_us = 50u,
    .edge_latency_us = 40u,
    .frame_latency_us = 2u * FRAME_US,
    .time_error_us = 20u,
};

static volatile uint8_t heard[HEARD_BYTES];
static volatile uint8_t heard_count; /* both modulo 256 */
static uint8_t          taken_count;

ISR(USART_RX_vect)
{
    uint8_t byte = UDR0;
    heard[heard_count] = byte;
    ++heard_count;
}

/* No scans here. */
void scan_on_time(void)
{
}

void port_set_line(uint8_t channel, bool high)
{
    if (channel != BOARD_TRIGGER_CHANNEL) {
        return;
    }
    if (high) {
        PORTB |= BOARD_TRIGGER_BIT;
    } else {
        PORTB &= (uint8_t)~BOARD_TRIGGER_BIT;
    }
}

void port_pass_us(uint32_t us)
{
    uint8_t  last = TCNT2;
    uint32_t left = us * COUNTS_PER_US;
    while (left != 0u) {
        uint8_t now = TCNT2;
        uint8_t passed = (uint8_t)(now - last);
        left = passed < left ? left - passed : 0u;
        last = now;
    }
}

/* What the test before has left in the queue goes out first. */
static void empty_bus(void)
{
    while ((UCSR0B & _BV(UDRIE0)) != 0u) {
    }
    port_pass_us(FRAME_US);
}

static void start_bus(void)
{
    bus_start();
    UCSR0B |= _BV(RXCIE0);
    taken_count = heard_count;
}

bool port_power_up_at(uint32_t ticks)
{
    TCCR2B = _BV(CS21);
    empty_bus();
    cli();
    hal_edge_disarm(BOARD_TRIGGER_CHANNEL);
    DDRB |= BOARD_TRIGGER_BIT;
    port_set_line(BOARD_TRIGGER_CHANNEL, false);
    clock_start();
    deferred_start();
    axis_start();
    axis_place(0);
    start_bus();
    sei();
    clock_set_ticks(ticks);
    return true;
}

void port_power_up(void)
{
    (void)port_power_up_at(0u);
}

void port_place_axis(uint8_t axis, int32_t position_counts)
{
    if (axis == BOARD_AXIS) {
        axis_place(position_counts);
    }
}

bool port_receive(uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    if ((uint8_t)(heard_count - taken_count) < HAL_BUS_FRAME_BYTES) {
        return false;
    }
    for (uint8_t i = 0u; i < HAL_BUS_FRAME_BYTES; ++i) {
        frame[i] = heard[taken_count];
        ++taken_count;
    }
    return true;
}
