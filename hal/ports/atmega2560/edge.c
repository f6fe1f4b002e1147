/*
 * The trigger line on the input capture pin of Timer 1 (PD4): the timer itself keeps the count of
 * the edge, however late the interrupt.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "clock.h"
#include "hal_critical.h"
#include "hal_edge.h"
#include "hal_edge_events.h"
#include "hal_error.h"

#define CHANNEL 0u
#define LINE    (1u << PD4)

static bool is_active_low;

ISR(TIMER1_CAPT_vect)
{
    hal_edge_on_latch(CHANNEL, clock_extend(ICR1));
}

static void stop(void)
{
    TIMSK1 &= (uint8_t)~(1u << ICIE1);
    TIFR1 = 1u << ICF1;
}

/* The choice of the edge itself can raise the flag, so the flag is cleared after it. */
static void start(bool active_low)
{
    is_active_low = active_low;
    if (active_low) {
        TCCR1B &= (uint8_t)~(1u << ICES1);
    } else {
        TCCR1B |= 1u << ICES1;
    }
    TIFR1 = 1u << ICF1;
    TIMSK1 |= 1u << ICIE1;
}

/* The chip's own filter is four clocks, 0.25 µs: no whole microsecond can be promised. */
int hal_edge_arm(const hal_edge_config_t *config)
{
    if (config->channel != CHANNEL) {
        return HAL_ERR_CHANNEL;
    }
    if (config->glitch_filter_us != 0u) {
        return HAL_ERR_CONFIG;
    }
    hal_critical_state_t saved = hal_critical_enter();
    stop();
    start(config->active_low);
    hal_critical_exit(saved);
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel == CHANNEL) {
        hal_critical_state_t saved = hal_critical_enter();
        stop();
        hal_critical_exit(saved);
    }
}

bool hal_edge_level(uint8_t channel)
{
    return channel == CHANNEL && ((PIND & LINE) != 0u) != is_active_low;
}
