/*
 * Two pulse trains, as of the encoders at both ends of a drive chain. The port stamps one kind of
 * edge and keeps the stamps until the task takes them. For boards that have two such inputs; any
 * other leaves these functions out.
 *
 * A line of an encoder is a mark of some width. Forward its first flank gives the rising edge, and
 * backward the same flank gives the falling one: whoever compares both senses stamps by sense.
 */
#ifndef HAL_PULSE_H
#define HAL_PULSE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAL_PULSE_CHANNELS 2u

typedef enum {
    HAL_PULSE_RISING,
    HAL_PULSE_FALLING,
} hal_pulse_edge_t;

typedef struct {
    uint32_t captured_ticks; /* hal_clock ticks at the edge, as for hal_edge_on_latch() */
    uint8_t  channel;        /* 0 or 1 */
    uint8_t  lost; /* pulses of either channel that the port had no room for between the one before
                      and this one; UINT8_MAX: so many or more */
} hal_pulse_t;

/*
 * Watch both lines for such edges, from now on: no pulse from before is handed out. Task. Returns
 * HAL_OK, or HAL_ERR_CONFIG if the lines cannot be had.
 */
int hal_pulse_start(hal_pulse_edge_t edge);

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
