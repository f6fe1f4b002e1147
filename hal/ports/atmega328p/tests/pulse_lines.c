/*
 * The pulse lines of the ATmega328P, on the chip itself: driven by the pins' own outputs, which
 * capture and interrupt see as they see foreign ones. Time passes by Timer 2.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../clock.h"
#include "../pulse.h"
#include "contract/pulse_lines_under_test.h"
#include "hal_pulse.h"

#define INPUT_BIT     _BV(PD2)
#define OUTPUT_BIT    _BV(PB0)
#define COUNTS_PER_US 2u /* 16 MHz / 8 */

const pulse_facts_t PULSES = {.latency_us = 30u, .spacing_us = 20u, .held_most = PULSE_NOTES};

void pulse_lines_power_up(uint32_t ticks)
{
    TCCR2B = _BV(CS21);
    hal_pulse_stop();
    DDRD |= INPUT_BIT;
    DDRB |= OUTPUT_BIT;
    pulse_line_set(0u, false);
    pulse_line_set(1u, false);
    clock_start();
    sei();
    clock_set_ticks(ticks);
}

void pulse_line_set(uint8_t channel, bool high)
{
    volatile uint8_t *port = channel == 0u ? &PORTD : &PORTB;
    uint8_t           bit = channel == 0u ? INPUT_BIT : OUTPUT_BIT;
    *port = (uint8_t)(high ? *port | bit : *port & (uint8_t)~bit);
}

void pulse_lines_pass_us(uint32_t us)
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
