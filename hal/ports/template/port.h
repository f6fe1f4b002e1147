/* What this board has beyond hal/include: its start, and the motion that a cycle asks for. */
#ifndef TEMPLATE_PORT_H
#define TEMPLATE_PORT_H

#include <stdbool.h>
#include <stdint.h>

/* Clocks, pins, timers and the bus, and interrupts on, but no scans yet. Task, once. */
void port_start(void);

/* From now on port_scan_interrupt() comes every period. Task, once. */
void port_start_scans(uint16_t period_us);

/* Begin to move the axis to `target_counts`. Task. */
void port_move(int32_t target_counts, double feed_mm_min);

/* Bring the axis to rest as fast as it may. Task. */
void port_stop(void);

/* True from port_move() until standstill. Task. */
bool port_is_moving(void);

/* The vector of the trigger line. Interrupt. */
void port_edge_interrupt(void);

/* The vector of the timer that sets the PLC's scan period. Interrupt. */
void port_scan_interrupt(void);

/* main.c: one scan of the PLC. port_scan_interrupt() calls it. Interrupt. */
void port_on_scan(void);

#endif
