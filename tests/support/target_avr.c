/*
 * A suite on an AVR in simavr. The report leaves through GPIOR0, which costs no time and leaves the
 * UART to the bus under test; the end through GPIOR1. tests/boards/avr_test_run.c listens to both.
 */
#include "target.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "unity.h"

void target_put_char(char character)
{
    GPIOR0 = (unsigned char)character;
}

void target_done(void)
{
    cli();
    GPIOR1 = Unity.TestFailures != 0u ? 1u : 0u;
    for (;;) {
    }
}
