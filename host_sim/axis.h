/*
 * Motion stage: one axis, along the approach. Position 0 is the nominal surface, positive is past
 * it. Every motion starts from rest, and is a trapezoid: constant acceleration, feed, constant
 * deceleration.
 */
#ifndef SIM_AXIS_H
#define SIM_AXIS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_time.h"

/* Times are in ns from `start`, lengths in µm. */
typedef struct {
    double   accel;       /* µm/ns², > 0 */
    double   from_um;     /* where the motion began */
    double   sense;       /* 1 or -1 */
    double   speed;       /* µm/ns, the highest reached */
    double   accel_end;   /* end of the acceleration */
    double   decel_start; /* begin of the deceleration */
    double   decel_end;   /* standstill */
    double   ramp_um;     /* way of the acceleration, and of the deceleration */
    double   to_brake_um; /* way up to the deceleration */
    sim_ns_t start;       /* master clock */
} sim_axis_t;

/* At rest at `position_um`. */
void sim_axis_place(sim_axis_t *axis, double accel_mm_s2, double position_um, sim_ns_t now);

/*
 * Move to `target_um` at `feed_mm_min`. A motion towards the surface has reached its speed there,
 * and goes on at that speed (step 1 of the nominal chain).
 */
void sim_axis_move(sim_axis_t *axis, double target_um, double feed_mm_min, sim_ns_t now);

/* Begin to decelerate after `reaction`, if the axis is not doing so already. */
void sim_axis_stop(sim_axis_t *axis, sim_ns_t reaction, sim_ns_t now);

double sim_axis_position_um(const sim_axis_t *axis, sim_ns_t now);

/* Speed along the approach in µm/µs. */
double sim_axis_speed_um_us(const sim_axis_t *axis, sim_ns_t now);

/* When the axis comes, or came, to rest. */
sim_ns_t sim_axis_standstill(const sim_axis_t *axis);

/* When the motion passes `position_um`, SIM_NEVER if it does not reach it. */
sim_ns_t sim_axis_crossing(const sim_axis_t *axis, double position_um);

#endif
