/*
 * The axis: a stepper behind step and direction, driven by Timer0 at one speed, without ramps. Its
 * position is the number of pulses given, forward less backward.
 */
#ifndef ATMEGA328P_AXIS_H
#define ATMEGA328P_AXIS_H

#include <stdbool.h>
#include <stdint.h>

#define AXIS_COUNTS_PER_MM   500 /* 2 µm a step */
#define AXIS_FEED_MIN_MM_MIN 7.5 /* slower ones become this */
#define AXIS_FEED_MAX_MM_MIN 3000.0

/* Pins and timer; the axis rests at 0. Task, once, interrupts masked. */
void axis_start(void);

/* Say where the axis rests. Task. */
void axis_place(int32_t position_counts);

/*
 * Begin to move to `target_counts`, at most 2^31 − 1 counts away, at the feed, cut to its limits
 * and rounded to a whole number of timer ticks a step: exact at 30, 60, 100, 300, 1000 and 3000
 * mm/min. A move under way is replaced. Task.
 */
void axis_move(int32_t target_counts, double feed_mm_min);

/* No further step. Task. */
void axis_stop(void);

/* True from axis_move() until the last step. Task. */
bool axis_is_moving(void);

/* The position; only for axis_position_masked(). A rig compares it with the pulses on the pin. */
extern volatile int32_t axis_position;

/* hal_axis_position_counts() with interrupts masked. ISR. */
static inline int32_t axis_position_masked(void)
{
    return axis_position;
}

/*
 * From now on hal_axis_position_counts() tells this position, until axis_release_position(). For
 * the delivery of an edge (deferred.h): neither a scan nor the task runs before it is over.
 */
void axis_hold_position(int32_t position_counts);
void axis_release_position(void);

#endif
