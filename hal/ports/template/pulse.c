/* The functions of hal_pulse.h, for a board with two pulse inputs; any other leaves the file out.
 */
#include "hal_pulse.h"

#include "hal_error.h"

int hal_pulse_start(hal_pulse_edge_t edge)
{
    (void)edge;
    /* Forget what is kept, choose the edges, clear both flags, then switch both interrupts on.
     */
    return HAL_OK;
}

void hal_pulse_stop(void)
{
    /* Switch both interrupts off, and forget what is kept. */
}

bool hal_pulse_take(hal_pulse_t *pulse)
{
    /*
     * The oldest of a ring that the interrupts fill: the capture register, or the clock read first
     * thing. Where the ring is full they count and drop until the task has caught up; the next
     * pulse tells.
     */
    (void)pulse;
    return false;
}
