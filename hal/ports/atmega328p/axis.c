#include "axis.h"

#include <avr/interrupt.h>

#include "board.h"
#include "hal_axis.h"
#include "hal_critical.h"

#define S_PER_MIN     60.0
#define TIMER_TICKS   256u
#define CYCLES_MM_MIN (S_PER_MIN * (double)BOARD_CLOCK_HZ / AXIS_COUNTS_PER_MM)

volatile int32_t axis_position;

static int32_t           held_position;
static bool              is_held;
static volatile uint32_t steps_left;
static int8_t            sense = 1;

/* The pulse is as long as the counting: some 2 µs, enough for the usual drivers. */
ISR(TIMER0_COMPA_vect)
{
    PORTD |= BOARD_STEP_BIT;
    axis_position += sense;
    if (--steps_left == 0u) {
        TIMSK0 = 0u;
    }
    PORTD &= (uint8_t)~BOARD_STEP_BIT;
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    if (axis != BOARD_AXIS) {
        return 0;
    }
    if (is_held) {
        return held_position;
    }
    hal_critical_state_t saved = hal_critical_enter();
    int32_t              counts = axis_position;
    hal_critical_exit(saved);
    return counts;
}

void axis_start(void)
{
    DDRD |= BOARD_STEP_BIT | BOARD_DIRECTION_BIT;
    TCCR0A = _BV(WGM01);
    OCR0A = UINT8_MAX;
}

void axis_place(int32_t position_counts)
{
    hal_critical_state_t saved = hal_critical_enter();
    axis_position = position_counts;
    hal_critical_exit(saved);
}

void axis_hold_position(int32_t position_counts)
{
    held_position = position_counts;
    is_held = true;
}

void axis_release_position(void)
{
    is_held = false;
}

static double within_limits(double feed_mm_min)
{
    if (feed_mm_min < AXIS_FEED_MIN_MM_MIN) {
        return AXIS_FEED_MIN_MM_MIN;
    }
    return feed_mm_min > AXIS_FEED_MAX_MM_MIN ? AXIS_FEED_MAX_MM_MIN : feed_mm_min;
}

/*
 * The finest prescaler with which a step still fits into the timer. The compare value comes before
 * the clock, and the count is cleared while the timer runs: simavr 1.6 never starts one whose
 * compare value is 0, and forgets a count that is written while it stands.
 */
static void set_interval(uint32_t cycles)
{
    static const struct {
        uint16_t divider;
        uint8_t  bits;
    } PRESCALERS[] = {
        {8u, _BV(CS01)},
        {64u, _BV(CS01) | _BV(CS00)},
        {256u, _BV(CS02)},
        {1024u, _BV(CS02) | _BV(CS00)},
    };
    uint8_t chosen = 0u;
    while (cycles > (uint32_t)PRESCALERS[chosen].divider * TIMER_TICKS) {
        ++chosen;
    }
    uint32_t divider = PRESCALERS[chosen].divider;
    OCR0A = (uint8_t)((cycles + divider / 2u) / divider - 1u);
    TCCR0B = PRESCALERS[chosen].bits;
    TCNT0 = 0u;
}

static void set_direction(bool backward)
{
    sense = backward ? -1 : 1;
    if (backward) {
        PORTD |= BOARD_DIRECTION_BIT;
    } else {
        PORTD &= (uint8_t)~BOARD_DIRECTION_BIT;
    }
}

void axis_move(int32_t target_counts, double feed_mm_min)
{
    axis_stop();
    int32_t way = target_counts - axis_position;
    if (way == 0) {
        return;
    }
    set_direction(way < 0);
    steps_left = way < 0 ? 0u - (uint32_t)way : (uint32_t)way;
    set_interval((uint32_t)(CYCLES_MM_MIN / within_limits(feed_mm_min) + 0.5));
    TIFR0 = _BV(OCF0A);
    TIMSK0 = _BV(OCIE0A);
}

void axis_stop(void)
{
    TIMSK0 = 0u;
}

bool axis_is_moving(void)
{
    return TIMSK0 != 0u;
}
