/*
 * The functions of hal/include with empty bodies: copy the folder, then fill each in where its
 * comment stands. docs/PORTING.md has the checklist, tests/contract the suites to pass.
 */
#include "port.h"

#include "hal_axis.h"
#include "hal_bus.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "hal_edge.h"
#include "hal_edge_events.h"
#include "hal_error.h"

#define CHANNEL 0u
#define TICK_PS 250000u /* of a timer at 4 MHz */

void port_start(void)
{
    /* Set pins, start the clock, the bus and the motion, switch interrupts on. */
}

void port_start_scans(uint16_t period_us)
{
    /* Start a timer that is reloaded by hardware, so that a late interrupt moves no later one. */
    (void)period_us;
}

/* ---- hal_clock.h ---- */

uint32_t hal_clock_now_ticks(void)
{
    /*
     * A 32-bit timer: read its register. A shorter one: count its overflows in an interrupt and
     * join both under hal_critical; an overflow that is pending belongs to the reading.
     */
    return 0u;
}

uint32_t hal_clock_tick_ps(void)
{
    return TICK_PS;
}

/* ---- hal_critical.h ---- */

hal_critical_state_t hal_critical_enter(void)
{
    /* Save the interrupt mask, mask, and then a barrier to the compiler. */
    return 0u;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    /* A barrier to the compiler, and then the mask as it was: a section inside another stays
     * masked. */
    (void)saved;
}

/* ---- hal_axis.h ---- */

int32_t hal_axis_position_counts(uint8_t axis)
{
    /* The counter of the encoder or of the steps, in one piece, and 0 for an axis there is not. */
    (void)axis;
    return 0;
}

/* ---- hal_edge.h ---- */

int hal_edge_arm(const hal_edge_config_t *config)
{
    if (config->channel != CHANNEL) {
        return HAL_ERR_CHANNEL;
    }
    /*
     * Set polarity and filter (or return HAL_ERR_CONFIG), clear the flag of an edge that came
     * before, then switch the interrupt on: in this order.
     */
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    /* Switch the interrupt off; on return it must not be running or pending. */
    (void)channel;
}

bool hal_edge_level(uint8_t channel)
{
    /* The pin behind the filter, turned round if it is active low. */
    (void)channel;
    return false;
}

void port_edge_interrupt(void)
{
    /* The capture register if there is one. Otherwise the clock, before anything else. */
    uint32_t captured_ticks = hal_clock_now_ticks();

    hal_edge_on_latch(CHANNEL, captured_ticks);
    /* Acknowledge the interrupt. */
}

/* ---- hal_bus.h ---- */

int hal_bus_send(const uint8_t frame[HAL_BUS_FRAME_BYTES])
{
    /*
     * Copy the bytes into a queue that the transmit interrupt empties, or into a free mailbox of
     * the CAN controller that keeps the order; HAL_ERR_BUSY while there is no room.
     */
    (void)frame;
    return HAL_OK;
}

/* ---- the board's own ---- */

void port_scan_interrupt(void)
{
    /* Acknowledge the interrupt. */
    port_on_scan();
}

void port_move(int32_t target_counts, double feed_mm_min)
{
    /* Hand the motion over to the controller of the axis. */
    (void)target_counts;
    (void)feed_mm_min;
}

void port_stop(void)
{
    /* Decelerate now; what is queued is dropped. */
}

bool port_is_moving(void)
{
    /* Already true when port_move() returns, even if the axis only starts later. */
    return false;
}
