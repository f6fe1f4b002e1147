#include "deferred.h"

#include <avr/interrupt.h>
#include <stdbool.h>

#include "edge_line.h"
#include "scan.h"

static volatile bool is_running;

void deferred_start(void)
{
    DDRD |= BOARD_DEFER_BIT;
    PCMSK2 = BOARD_DEFER_BIT;
    PCICR |= _BV(PCIE2);
}

ISR(PCINT2_vect)
{
    deferred_run();
}

/* The last look comes with interrupts off: what falls due later finds that nothing is running. */
void deferred_run(void)
{
    if (is_running) {
        return;
    }
    is_running = true;
    while (edge_line_is_waiting() || scan_is_due()) {
        sei();
        edge_line_deliver();
        scan_run();
        cli();
    }
    is_running = false;
}
