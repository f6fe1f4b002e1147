/*
 * What may go wrong on a controller, as code of this port: off by default, switched on by the build
 * with -DDISTURBANCE_…=…, one program for each. A coarser clock is -DCLOCK_PRESCALER=8 (clock.h).
 */
#ifndef ATMEGA328P_DISTURBANCE_H
#define ATMEGA328P_DISTURBANCE_H

#include <stdbool.h>
#include <stdint.h>

/* Another interrupt, of Timer1's compare A: every so often it runs so long, all others masked. */
#ifndef DISTURBANCE_INTERRUPT_US
#define DISTURBANCE_INTERRUPT_US 0
#endif
#ifndef DISTURBANCE_INTERRUPT_PERIOD_US
#define DISTURBANCE_INTERRUPT_PERIOD_US 1000 /* at most 4000 */
#endif

/* The task masks interrupts so long, about every so often. */
#ifndef DISTURBANCE_CRITICAL_US
#define DISTURBANCE_CRITICAL_US 0
#endif
#ifndef DISTURBANCE_CRITICAL_PERIOD_US
#define DISTURBANCE_CRITICAL_PERIOD_US 1000
#endif

/* Every so many scans, the body of one takes so long. */
#ifndef DISTURBANCE_SCAN_BODY_US
#define DISTURBANCE_SCAN_BODY_US 0
#endif
#ifndef DISTURBANCE_SCAN_BODY_EVERY
#define DISTURBANCE_SCAN_BODY_EVERY 1
#endif

/* The edge interrupt believes an edge, and stamps it, only after the line has rested so long. */
#ifndef DISTURBANCE_FILTER_US
#define DISTURBANCE_FILTER_US 0
#endif

/* Task, once, interrupts masked, after clock_start(). */
void disturbance_start(void);

/* One round of the task. */
void disturbance_in_task(void);

/* The body of one scan. Interrupt, not masked. */
void disturbance_in_scan(void);

/* Whether there is a filter; a constant, so that without one nothing is left of it. */
static inline bool disturbance_filters(void)
{
    return DISTURBANCE_FILTER_US != 0;
}

/* Wait; true, and `timer_ticks` of Timer1 are those of the end, if the line has rested. ISR. */
bool disturbance_passes_filter(uint16_t *timer_ticks);

#endif
