#include "stepper.h"

#include <avr/interrupt.h>

#include "board.h"
#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_critical.h"

#define S_PER_MIN        60u
#define TICK_PS          62500u
#define HALF_STEP        (STEPPER_COUNTS_PER_STEP / 2)
#define CYCLES_MM_MIN    (BOARD_CLOCK_HZ * S_PER_MIN / STEPPER_STEPS_PER_MM)
#define SLOW_STEP_CYCLES (BOARD_CLOCK_HZ / 2000u) /* from here on eight ticks make a step */
#define PULSE_PRELOAD    236u                     /* 10 µs until Timer0 is over */
#define PULSE_PRESCALER  _BV(CS01)
#define STEPPER_INTERVAL (_BV(WGM12) | _BV(CS10))

typedef struct {
    uint16_t interval_ticks;
    uint16_t rate;
    uint8_t  shift;
    int8_t   sense;
} order_t;

stepper_tick_t stepper_tick;

static order_t       order;
static volatile bool is_ordered;
static int32_t       placed_counts;
static int32_t       held_counts;
static bool          is_held;

/* grbl counts a pulse when it decides on it, a tick before it comes; here both are one. */
static void give_pulse(void)
{
    PORTD |= BOARD_STEP_BIT;
    TCCR0B = PULSE_PRESCALER;
    TCNT0 = PULSE_PRELOAD;
    stepper_tick.steps += stepper_tick.sense;
    stepper_tick.phase = 0u;
}

ISR(TIMER0_OVF_vect)
{
    PORTD &= (uint8_t)~BOARD_STEP_BIT;
    TCCR0B = 0u;
}

/* The first step comes half a step after the start, as with grbl. */
static void obey_order(void)
{
    stepper_tick.interval_ticks = order.interval_ticks;
    stepper_tick.rate = order.rate;
    stepper_tick.shift = order.shift;
    stepper_tick.sense = order.sense;
    stepper_tick.phase = (uint8_t)((1u << order.shift) / 2u);
    OCR1A = order.interval_ticks - 1u;
    is_ordered = false;
}

/* Edges are delivered last, with interrupts on, so that pin and pulses are served meanwhile. */
ISR(TIMER1_COMPA_vect)
{
    stepper_tick.clock_ticks += stepper_tick.interval_ticks;
    if (stepper_tick.sense != 0 && ++stepper_tick.phase >> stepper_tick.shift != 0u) {
        give_pulse();
    }
    if (is_ordered) {
        obey_order();
    }
    stepper_on_tick_served();
}

/* simavr 1.6 never starts a timer whose compare value is 0. */
void stepper_start(uint32_t ticks)
{
    DDRD |= BOARD_STEP_BIT | BOARD_DIRECTION_BIT;
    TIMSK0 = _BV(TOIE0);
    stepper_tick = (stepper_tick_t){.clock_ticks = ticks, .interval_ticks = STEPPER_REST_TICKS};
    is_ordered = false;
    placed_counts = 0;
    OCR1A = STEPPER_REST_TICKS - 1u;
    TCCR1A = 0u;
    TCCR1B = STEPPER_INTERVAL;
    TCNT1 = 0u;
    TIFR1 = _BV(OCF1A);
    TIMSK1 = _BV(OCIE1A);
}

static void give_order(order_t given)
{
    hal_critical_state_t saved = hal_critical_enter();
    order = given;
    is_ordered = true;
    hal_critical_exit(saved);
}

void stepper_place(int32_t position_counts)
{
    hal_critical_state_t saved = hal_critical_enter();
    stepper_tick.sense = 0;
    stepper_tick.steps = 0;
    placed_counts = position_counts;
    hal_critical_exit(saved);
}

static uint16_t within_limits(uint16_t feed_mm_per_min)
{
    if (feed_mm_per_min < STEPPER_FEED_MIN_MM_MIN) {
        return STEPPER_FEED_MIN_MM_MIN;
    }
    return feed_mm_per_min > STEPPER_FEED_MAX_MM_MIN ? STEPPER_FEED_MAX_MM_MIN : feed_mm_per_min;
}

void stepper_run(uint16_t feed_mm_per_min)
{
    if (feed_mm_per_min == 0u) {
        give_order((order_t){.interval_ticks = STEPPER_REST_TICKS});
        return;
    }
    uint32_t step_cycles = CYCLES_MM_MIN / within_limits(feed_mm_per_min);
    uint8_t  shift = step_cycles >= SLOW_STEP_CYCLES ? 3u : 2u;
    uint32_t interval_ticks = step_cycles >> shift; /* 1000 … 50,000 */
    PORTD &= (uint8_t)~BOARD_DIRECTION_BIT;
    give_order((order_t){
        .interval_ticks = (uint16_t)interval_ticks,
        .rate = (uint16_t)((1ul << 24) / interval_ticks),
        .shift = shift,
        .sense = 1,
    });
}

/* ---- moments ---- */

uint32_t stepper_clock_ticks(const stepper_moment_t *moment)
{
    return moment->tick.clock_ticks + moment->since_ticks;
}

/*
 * Of a step, in counts: what its whole ticks make, and the part of the one that is running. For an
 * interrupt: without a division.
 */
int32_t stepper_counts(const stepper_moment_t *moment)
{
    const stepper_tick_t *tick = &moment->tick;
    int32_t               counts = placed_counts + tick->steps * STEPPER_COUNTS_PER_STEP;
    if (tick->sense == 0) {
        return counts;
    }
    uint32_t part = moment->since_ticks * tick->rate >> 16;
    uint32_t passed = ((uint32_t)tick->phase * STEPPER_COUNTS_PER_STEP + part) >> tick->shift;
    return counts + tick->sense * ((int32_t)passed - HALF_STEP);
}

static stepper_moment_t present(void)
{
    stepper_moment_t     moment;
    hal_critical_state_t saved = hal_critical_enter();
    stepper_now(&moment);
    hal_critical_exit(saved);
    return moment;
}

uint32_t hal_clock_now_ticks(void)
{
    stepper_moment_t moment = present();
    return stepper_clock_ticks(&moment);
}

uint32_t hal_clock_tick_ps(void)
{
    return TICK_PS;
}

void stepper_hold_position(int32_t position_counts)
{
    held_counts = position_counts;
    is_held = true;
}

void stepper_release_position(void)
{
    is_held = false;
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    if (axis != BOARD_AXIS) {
        return 0;
    }
    if (is_held) {
        return held_counts;
    }
    stepper_moment_t moment = present();
    return stepper_counts(&moment);
}
