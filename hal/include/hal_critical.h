/*
 * A stretch of code that no interrupt of the firmware may cut in two. Keep it to a few
 * instructions. Both calls are barriers to the compiler: nothing moves across them.
 */
#ifndef HAL_CRITICAL_H
#define HAL_CRITICAL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef uint32_t hal_critical_state_t; /* the port's saved interrupt mask */

/* Mask the interrupts that call the firmware and return the mask as it was. Nests. Any context. */
hal_critical_state_t hal_critical_enter(void);

/* Put the mask back. `saved` is what the matching hal_critical_enter() returned. Any context. */
void hal_critical_exit(hal_critical_state_t saved);

#ifdef __cplusplus
}
#endif

#endif
