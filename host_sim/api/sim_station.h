/* A station of the sphere, for the users of the shared library. Python reads this header too. */
#ifndef API_SIM_STATION_H
#define API_SIM_STATION_H

#include <stdint.h>

/* One measurement of the sphere. */
typedef struct {
    double  angle_deg[3];
    double  centre_mm[3];
    double  radius_mm;
    int32_t axis;   /* SIM_ROTARY_* being measured */
    int32_t serves; /* bit 1 << axis of all axes whose measurement this is */
    int32_t approach;
    int32_t is_reference;
    int32_t is_second; /* of two approaches to one position */
} sim_station_t;

#endif
