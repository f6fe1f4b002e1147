#include "clock.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdbool.h>

#include "hal_clock.h"
#include "hal_critical.h"

#define TICK_PS    62500u
#define HALF       0x8000u
#define LOW_BITS   16u
#define NO_DIVIDER (1u << CS10)

static volatile uint16_t overflows;

ISR(TIMER1_OVF_vect)
{
    ++overflows;
}

/* Running first: a count written to a timer that stands is lost in simavr 1.6. */
void clock_start(uint32_t ticks)
{
    hal_critical_state_t saved = hal_critical_enter();
    TCCR1A = 0u;
    TCCR1B = (uint8_t)((TCCR1B & (1u << ICES1)) | NO_DIVIDER);
    overflows = (uint16_t)(ticks >> LOW_BITS);
    TCNT1 = (uint16_t)ticks;
    TIFR1 = 1u << TOV1;
    TIMSK1 |= 1u << TOIE1;
    hal_critical_exit(saved);
}

/* The counter is read before the flag: one that has wrapped since reads high and takes no carry. */
static uint32_t read_masked(void)
{
    uint16_t low = TCNT1;
    uint16_t high = overflows;
    if ((TIFR1 & (1u << TOV1)) != 0u && low < HALF) {
        ++high;
    }
    return (uint32_t)high << LOW_BITS | low;
}

uint32_t clock_extend(uint16_t captured)
{
    uint32_t now = read_masked();
    return now - (uint16_t)((uint16_t)now - captured);
}

uint32_t hal_clock_now_ticks(void)
{
    hal_critical_state_t saved = hal_critical_enter();
    uint32_t             now = read_masked();
    hal_critical_exit(saved);
    return now;
}

uint32_t hal_clock_tick_ps(void)
{
    return TICK_PS;
}
