/*
 * Faults of a real program, off unless the build sets a constant. Rigs show with them that a
 * measured gap names its cause.
 */
#ifndef QEMU_DISTURBANCE_H
#define QEMU_DISTURBANCE_H

#include <stdbool.h>
#include <stdint.h>

/* Another interrupt as urgent as the trigger line's: its length, 0 for none, and its period. */
#ifndef DISTURBANCE_INTERRUPT_US
#define DISTURBANCE_INTERRUPT_US 0u
#endif
#ifndef DISTURBANCE_INTERRUPT_PERIOD_US
#define DISTURBANCE_INTERRUPT_PERIOD_US 1000u
#endif

/* The task masks all interrupts for so long, 0 for never, and how often it does. */
#ifndef DISTURBANCE_CRITICAL_US
#define DISTURBANCE_CRITICAL_US 0u
#endif
#ifndef DISTURBANCE_CRITICAL_PERIOD_US
#define DISTURBANCE_CRITICAL_PERIOD_US 1000u
#endif

/* One scan out of so many works so long, 0 for none, after it has read its inputs. */
#ifndef DISTURBANCE_SCAN_BODY_US
#define DISTURBANCE_SCAN_BODY_US 0u
#endif
#ifndef DISTURBANCE_SCAN_BODY_EVERY
#define DISTURBANCE_SCAN_BODY_EVERY 1u
#endif

/* The device clock counts 2^shift ticks of the core as one, 0 … 10. */
#ifndef DISTURBANCE_PRESCALER_SHIFT
#define DISTURBANCE_PRESCALER_SHIFT 0u
#endif

/* The line counts as changed after so many equal samples, 0 for no filter; how often it is sampled.
 */
#ifndef DISTURBANCE_FILTER_SAMPLES
#define DISTURBANCE_FILTER_SAMPLES 0u
#endif
#ifndef DISTURBANCE_FILTER_PERIOD_US
#define DISTURBANCE_FILTER_PERIOD_US 10u
#endif

/* ---- disturbance.c ---- */

/* Work for so long. Any context. */
void disturbance_work(uint32_t us);

/* True once every period, which begins anew then; `since_ticks` is the caller's to keep. Task. */
bool disturbance_is_due(uint32_t *since_ticks, uint32_t period_us);

/* Mask all interrupts for a while, when it is time for that. Task, every round. */
void disturbance_critical_section(void);

/* What a scan does after its work. Interrupt. */
void disturbance_in_scan(void);

/* ---- the board's disturbing_interrupt.c ---- */

/* Start what the build has of them, after everything else. Task, once. */
void disturbance_start(void);

/* What the task does beside its work. Task, every round. */
void disturbance_in_task(void);

/* The level behind the software filter, or the pin's itself without one. Any context. */
bool disturbance_filtered(bool pin_is_high);

/* An edge behind a software filter, seen just now; in edge.c. Interrupt. */
void edge_on_filtered(bool is_high);

/* The vector of the disturbing interrupt. Interrupt. */
void disturbance_interrupt(void);

#endif
