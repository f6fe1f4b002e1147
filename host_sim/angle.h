/* Angles: campaigns have degrees, the C library has radians. */
#ifndef SIM_ANGLE_H
#define SIM_ANGLE_H

#include <math.h>

#define PI           3.14159265358979323846
#define RAD_PER_DEG  (PI / 180.0)
#define DEG_PER_TURN 360.0

/* A periodic error of gears, screws and encoders: one period a turn, of amplitude 1. */
static inline double sim_wave(double turns, double phase_deg)
{
    return sin(2.0 * PI * turns + phase_deg * RAD_PER_DEG);
}

#endif
