/*
 * Work of interrupts that may take longer than two edges are apart: it runs with interrupts on, so
 * that the short interrupts, above all that of the trigger line, come between. Edges are delivered
 * so, one at a time, and scans run so, one at a time; an edge is delivered in the midst of a scan,
 * but no scan begins in the midst of a delivery.
 *
 * It runs at the end of the interrupt that asks for it, or of the one that was interrupted by it.
 * An interrupt that should stay short asks by way of a software interrupt, a pin change on PD4
 * (edge_line.h), which is driven and left open. Nothing is switched off meanwhile: simavr 1.6
 * forgets an interrupt that falls due while it is.
 */
#ifndef ATMEGA328P_DEFERRED_H
#define ATMEGA328P_DEFERRED_H

/* The pin and its interrupt. Task, once, interrupts masked. */
void deferred_start(void);

#endif
