/*
 * Steps as grbl makes them: Timer1 is cleared at each compare and interrupts; of four or eight such
 * ticks (its smoothing of slow axes) the last one steps. No timer counts on, so the device clock is
 * the clock at the last tick and the time since, and so is the place of the axis.
 *
 * grbl stops that interrupt at rest; here it goes on every 2.5 ms, for the sake of the clock.
 */
#ifndef ATMEGA328P_GRBL_STEPPER_H
#define ATMEGA328P_GRBL_STEPPER_H

#include <avr/io.h>
#include <stdbool.h>
#include <stdint.h>

#define STEPPER_COUNTS_PER_STEP 256
#define STEPPER_STEPS_PER_MM    80
#define STEPPER_FEED_MIN_MM_MIN 30
#define STEPPER_FEED_MAX_MM_MIN 3000

#define STEPPER_REST_TICKS 40000u /* between two interrupts at rest */
#define STEPPER_READ_TICKS 32u    /* at most between reading Timer1 and its flag */

/* What holds from one tick to the next. */
typedef struct {
    int32_t  steps;          /* made since the axis was placed; first, for a rig */
    uint32_t clock_ticks;    /* the device clock at the tick */
    uint16_t interval_ticks; /* to the next one */
    uint16_t rate;           /* 1/256 of an interval in 65536 ticks: 2^24 / interval */
    uint8_t  phase;          /* ticks since the last step */
    uint8_t  shift;          /* 2^shift ticks make a step */
    int8_t   sense;          /* 1 forward, −1 backward, 0 at rest */
} stepper_tick_t;

/* A moment: what held at the last tick that was served, and the time since. */
typedef struct {
    stepper_tick_t tick;
    uint32_t       since_ticks;
} stepper_moment_t;

/* Only for stepper_moment(). A rig compares the steps with the pulses on the pin. */
extern stepper_tick_t stepper_tick;

/* Pins and timers, the axis at 0, at rest, the clock at `ticks`. Task, interrupts masked. */
void stepper_start(uint32_t ticks);

/* Put the axis somewhere, at rest. Task. */
void stepper_place(int32_t position_counts);

/* Run forward from the next tick on at a feed, cut to the limits; 0 stops. Task. */
void stepper_run(uint16_t feed_mm_per_min);

/* The device clock at a moment. Any context. */
uint32_t stepper_clock_ticks(const stepper_moment_t *moment);

/* Where the axis is then, between two steps as well: a pulse lets it pass half a step. Any context.
 */
int32_t stepper_counts(const stepper_moment_t *moment);

/*
 * The moment of a reading of Timer1, and of its compare flag as read next. A tick that is due, but
 * not served, came before the reading, unless the timer was just about to wrap. ISR, or masked for
 * less than an interval.
 */
static inline void stepper_moment(stepper_moment_t *moment, uint16_t timer_ticks, bool is_tick_due)
{
    uint16_t interval = stepper_tick.interval_ticks;
    bool     is_after = is_tick_due && timer_ticks < interval - STEPPER_READ_TICKS;
    moment->tick = stepper_tick;
    moment->since_ticks = is_after ? (uint32_t)interval + timer_ticks : timer_ticks;
}

/* The present moment. ISR, or masked. */
static inline void stepper_now(stepper_moment_t *moment)
{
    uint16_t timer_ticks = TCNT1;
    stepper_moment(moment, timer_ticks, (TIFR1 & _BV(OCF1A)) != 0u);
}

/* edge.c: a tick has been served. Last in the step interrupt; it may switch interrupts on and off.
 */
void stepper_on_tick_served(void);

/* hal_axis_position_counts() tells this from now on, until it is released. Delivery of an edge. */
void stepper_hold_position(int32_t position_counts);
void stepper_release_position(void);

#endif
