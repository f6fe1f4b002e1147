/*
 * A board with an ATmega under test, on the chip itself: it hears its own frames over a wire from
 * TXD to RXD.
 */
#include "contract/port_under_test.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../uart_bus.h"
#include "own_pins.h"

/* A chip with one UART leaves its number out. */
#ifndef USART_RX_vect
#define USART_RX_vect USART0_RX_vect
#endif

#define HEARD_BYTES   256u
#define COUNTS_PER_US 2u
#define FRAME_US      (HAL_BUS_FRAME_BYTES * BUS_BYTE_US)

static volatile uint8_t heard[HEARD_BYTES];
static volatile uint8_t heard_count; /* both modulo 256 */
static uint8_t          taken_count;

ISR(USART_RX_vect)
{
    uint8_t byte = UDR0;
    heard[heard_count] = byte;
    ++heard_count;
}

void port_set_line(uint8_t channel, bool high)
{
    if (channel == 0u) {
        own_set_line(high);
    }
}

void port_pass_us(uint32_t us)
{
    uint8_t  last = own_timer();
    uint32_t left = us * COUNTS_PER_US;
    while (left != 0u) {
        uint8_t now = own_timer();
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
    own_start_timer();
    empty_bus();
    cli();
    start_bus();
    own_start(ticks);
    sei();
    return true;
}

void port_power_up(void)
{
    (void)port_power_up_at(0u);
}

void port_place_axis(uint8_t axis, int32_t position_counts)
{
    if (axis == 0u) {
        own_place_axis(position_counts);
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
