/*
 * Two pulse trains, as of the encoders at both ends of a drive chain. The port stamps rising edges
 * and keeps them until the task takes them. For boards that have two such inputs; any other leaves
 * these functions out.
 */
#ifndef HAL_PULSE_H
#define HAL_PULSE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAL_PULSE_CHANNELS 2u

typedef struct {
    uint32_t captured_ticks; /* hal_clock ticks at the edge, as for hal_edge_on_latch() */
    uint8_t  channel;        /* 0 or 1 */
    uint8_t  lost; /* pulses of either channel that the port had no room for between the one before
                      and this one; UINT8_MAX: so many or more */
} hal_pulse_t;

/*
 * Watch both lines, from now on: no pulse from before is handed out. Task. Returns HAL_OK, or
 * HAL_ERR_CONFIG if the lines cannot be had.
 */
int hal_pulse_start(void);

/* Stop watching: nothing is handed out after the return. Task. */
void hal_pulse_stop(void);

/*
 * Take the oldest pulse; false if there is none. A channel's pulses come in order of time. Those of
 * different channels may change places where they are closer together than the port takes to see to
 * one. Task.
 */
bool hal_pulse_take(hal_pulse_t *pulse);

#ifdef __cplusplus
}
#endif

#endif
