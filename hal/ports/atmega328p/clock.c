#include "clock.h"

#include <avr/interrupt.h>

#include "board.h"
#include "hal_clock.h"
#include "hal_critical.h"

#define PS_PER_CYCLE (1000000ul / (BOARD_CLOCK_HZ / 1000000ul))

#define PRESCALER_BITS \
    (CLOCK_PRESCALER == 1 ? _BV(CS10) : CLOCK_PRESCALER == 8 ? _BV(CS11) : _BV(CS11) | _BV(CS10))

volatile uint16_t clock_overflows;

ISR(TIMER1_OVF_vect)
{
    ++clock_overflows;
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
    clock_overflows = (uint16_t)(ticks >> 16);
    hal_critical_exit(saved);
}

/* The timer is read before the flag: an overflow between the two finds a high reading. */
uint32_t hal_clock_now_ticks(void)
{
    hal_critical_state_t saved = hal_critical_enter();
    uint16_t             low = TCNT1;
    uint16_t             high = clock_overflows_before(low);
    hal_critical_exit(saved);
    return clock_join_ticks(high, low);
}

uint32_t hal_clock_tick_ps(void)
{
    return PS_PER_CYCLE * CLOCK_PRESCALER;
}
