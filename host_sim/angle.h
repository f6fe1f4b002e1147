/* Angles: campaigns have degrees, the C library has radians. */
#ifndef SIM_ANGLE_H
#define SIM_ANGLE_H

#define PI          3.14159265358979323846
#define RAD_PER_DEG (PI / 180.0)

#endif
