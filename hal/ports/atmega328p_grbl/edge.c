#include "edge.h"

#include <avr/interrupt.h>

#include "board.h"
#include "hal_critical.h"
#include "hal_edge.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "stepper.h"

#define NOTES 8u /* a power of two */

volatile uint16_t edge_line_lost;

static stepper_moment_t notes[NOTES];
static volatile uint8_t noted; /* since the start, both modulo 256 */
static volatile uint8_t delivered;
static volatile bool    is_delivering;
static bool             is_active_low;
static bool             was_deflected;

static bool is_deflected(void)
{
    return ((PINC & BOARD_PROBE_BIT) != 0u) != is_active_low;
}

static void note(uint16_t timer_ticks, bool is_tick_due)
{
    uint8_t here = noted;
    if ((uint8_t)(here - delivered) == NOTES) {
        ++edge_line_lost;
        return;
    }
    stepper_moment(&notes[here % NOTES], timer_ticks, is_tick_due);
    noted = (uint8_t)(here + 1u);
}

/* A line that is and was at rest has had a pulse meanwhile. */
ISR(PCINT1_vect)
{
    uint16_t timer_ticks = TCNT1;
    bool     is_tick_due = (TIFR1 & _BV(OCF1A)) != 0u;
    bool     is_now = is_deflected();
    if (is_now || !was_deflected) {
        note(timer_ticks, is_tick_due);
    }
    was_deflected = is_now;
}

/* The firmware finds the position of the edge, as of a counter that captures. */
static void deliver(const stepper_moment_t *moment)
{
    stepper_hold_position(stepper_counts(moment));
    hal_edge_on_latch(BOARD_PROBE_CHANNEL, stepper_clock_ticks(moment));
    stepper_release_position();
}

/* Deliver what is noted, one edge at a time, with interrupts on. */
void stepper_on_tick_served(void)
{
    if (is_delivering || delivered == noted) {
        return;
    }
    is_delivering = true;
    do {
        sei();
        deliver(&notes[delivered % NOTES]);
        cli();
        delivered = (uint8_t)(delivered + 1u);
    } while (delivered != noted);
    is_delivering = false;
}

static void stop_watching(void)
{
    PCICR &= (uint8_t)~_BV(PCIE1);
    delivered = noted;
}

int hal_edge_arm(const hal_edge_config_t *config)
{
    if (config->channel != BOARD_PROBE_CHANNEL) {
        return HAL_ERR_CHANNEL;
    }
    if (config->glitch_filter_us != 0u) {
        return HAL_ERR_CONFIG; /* the pin has none */
    }
    hal_critical_state_t saved = hal_critical_enter();
    stop_watching();
    is_active_low = config->active_low;
    was_deflected = is_deflected();
    PCMSK1 |= BOARD_PROBE_BIT;
    PCIFR = _BV(PCIF1);
    PCICR |= _BV(PCIE1);
    hal_critical_exit(saved);
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel == BOARD_PROBE_CHANNEL) {
        hal_critical_state_t saved = hal_critical_enter();
        stop_watching();
        hal_critical_exit(saved);
    }
}

bool hal_edge_level(uint8_t channel)
{
    return channel == BOARD_PROBE_CHANNEL && is_deflected();
}
