#include "clock.h"

#include <avr/interrupt.h>

#include "board.h"
#include "hal_clock.h"
#include "hal_critical.h"

#define PS_PER_CYCLE (1000000ul / (BOARD_CLOCK_HZ / 1000000ul))

#define PRESCALER_BITS \
    (CLOCK_PRESCALER == 1 ? _BV(CS10) : CLOCK_PRESCALER == 8 ? _BV(CS11) : _BV(CS11) | _BV(CS10))

static volatile uint16_t overflows;

ISR(TIMER1_OVF_vect)
{
    ++overflows;
}

void clock_start(void)
{
    TCCR1A = 0u;
    TIMSK1 |= _BV(TOIE1);
    TCCR1B |= PRESCALER_BITS;
}

void clock_set_ticks(uint32_t ticks)
{
    hal_critical_state_t saved = hal_critical_enter();
    TCNT1 = (uint16_t)ticks;
    TIFR1 = _BV(TOV1);
    overflows = (uint16_t)(ticks >> 16);
    hal_critical_exit(saved);
}

uint32_t clock_extend_ticks(uint16_t timer_ticks)
{
    return clock_join_ticks(overflows, timer_ticks, (TIFR1 & _BV(TOV1)) != 0u);
}

/* The timer is read before the flag: an overflow between the two finds a high reading. */
uint32_t hal_clock_now_ticks(void)
{
    hal_critical_state_t saved = hal_critical_enter();
    uint32_t             ticks = clock_extend_ticks(TCNT1);
    hal_critical_exit(saved);
    return ticks;
}

uint32_t hal_clock_tick_ps(void)
{
    return PS_PER_CYCLE * CLOCK_PRESCALER;
}
