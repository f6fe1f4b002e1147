/*
 * What the port calls when an edge comes in. Whoever wires firmware and port together (a port's
 * main.c) implements it and hands the edge to the skip input of that channel.
 */
#ifndef HAL_EDGE_EVENTS_H
#define HAL_EDGE_EVENTS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * An edge into the deflected state on an armed channel.
 * captured_ticks: hal_clock ticks at the edge, captured by hardware or else read first thing in the
 * interrupt. Context: the port's edge interrupt, interrupts masked; or right after it with
 * interrupts on, if neither the task nor a scan comes in between.
 */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks);

#ifdef __cplusplus
}
#endif

#endif
