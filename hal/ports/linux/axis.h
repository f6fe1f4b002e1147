/*
 * The axis of a bench without motion: a virtual one, whose position follows from the clock. It is
 * at 0 when CLOCK_MONOTONIC is 0 and has moved at one speed ever since, so the position at a known
 * instant is known as well. One axis, number 0; its counter wraps like every counter.
 */
#ifndef LINUX_AXIS_H
#define LINUX_AXIS_H

#include <stdint.h>

/* Move at `counts_per_s` from position 0 at CLOCK_MONOTONIC 0 on. */
void axis_run(double counts_per_s);

/* Stand still at `position_counts`. */
void axis_place(int32_t position_counts);

/*
 * Until axis_follow(), the position is that of this instant: what a position capture is in
 * hardware. The kernel stamps an edge some microseconds before this program hears of it.
 */
void axis_capture(uint64_t monotonic_ns);

/* The position is that of now again. */
void axis_follow(void);

#endif
