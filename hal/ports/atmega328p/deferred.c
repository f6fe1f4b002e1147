#include "deferred.h"

#include <avr/interrupt.h>
#include <stdbool.h>

#include "edge_line.h"
#include "scan.h"

static volatile bool is_delivering;
static volatile bool is_scanning;

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

/* Interrupts are off at every look: what falls due later finds that nothing of its kind is running.
 */
static void deliver_edges(void)
{
    is_delivering = true;
    while (edge_line_is_waiting()) {
        sei();
        edge_line_deliver();
        cli();
    }
    is_delivering = false;
}

static void run_scans(void)
{
    is_scanning = true;
    while (scan_is_due()) {
        sei();
        scan_run();
        cli();
    }
    is_scanning = false;
}

void deferred_run(void)
{
    if (is_delivering) {
        return;
    }
    deliver_edges();
    if (!is_scanning) {
        run_scans();
    }
}
