#include "scan.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#define COUNTS_PER_US 2u /* 16 MHz / 8 */

ISR(TIMER3_COMPA_vect)
{
    scan_on_period();
}

void scan_start(uint16_t period_us)
{
    scan_stop();
    OCR3A = (uint16_t)(COUNTS_PER_US * (uint32_t)period_us - 1u);
    TCCR3A = 0u;
    TCCR3B = (1u << WGM32) | (1u << CS31);
    TCNT3 = 0u;
    TIFR3 = 1u << OCF3A;
    TIMSK3 = 1u << OCIE3A;
}

void scan_stop(void)
{
    TIMSK3 = 0u;
    TCCR3B = 0u;
    TIFR3 = 1u << OCF3A;
}
