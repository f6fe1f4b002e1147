#include "deferred.h"

#include <avr/interrupt.h>
#include <stdbool.h>

#include "board.h"
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

/* Do what is due and not going on already. */
static void run_due(void)
{
    if (is_delivering) {
        return;
    }
    deliver_edges();
    if (!is_scanning) {
        run_scans();
    }
}

ISR(PCINT2_vect)
{
    run_due();
}

void scan_on_due(void)
{
    run_due();
}
