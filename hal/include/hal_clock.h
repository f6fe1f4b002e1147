/*
 * The device clock: a free-running counter that wraps from UINT32_MAX to 0.
 * Subtract two readings at their own width (see firmware/input/ticks.h); never compare them.
 */
#ifndef HAL_CLOCK_H
#define HAL_CLOCK_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The counter now. Any context. Never runs backwards but for the wrap. */
uint32_t hal_clock_now_ticks(void);

/*
 * Length of one tick in picoseconds, 1 to 1e9 (1 ms); constant while the program runs. Any
 * context.
 */
uint32_t hal_clock_tick_ps(void);

#ifdef __cplusplus
}
#endif

#endif
