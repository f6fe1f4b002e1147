/*
 * Speed for any direction, in the controller: fixed point, no trigonometry, no division.
 *
 * The half of an octahedron above the equator is laid flat: (u, v) = (dx, dy) / (|dx|+|dy|+|dz|)
 * lies in the square |u| + |v| ≤ 1, pole in its middle, equator on its rim. Each of its four faces
 * is divided into M·M triangles; vertices (i, j), |i| + |j| ≤ M, stand row by row, j from −M to M,
 * i rising. Between the three corners of a triangle the speed is linear: continuous everywhere,
 * without a seam at 0° or at the pole.
 */
#ifndef COMP_PRETRAVEL_LOOKUP_H
#define COMP_PRETRAVEL_LOOKUP_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PRETRAVEL_DIVISIONS_MAX = 32, /* M: 2113 vertices */
    PRETRAVEL_VERTEX_MAX = 255,
    PRETRAVEL_LOOKUP_PARTS = 128, /* what is looked up is in 1/128 of a vertex's unit */
    PRETRAVEL_NO_SPEED = 0        /* for a direction that is none, or below the equator */
};

typedef struct {
    const uint8_t *pole;      /* the middle one of 2·M² + 2·M + 1 vertices */
    uint8_t        divisions; /* M: 2, 4, 8, 16 or PRETRAVEL_DIVISIONS_MAX */
} pretravel_lookup_t;

/*
 * Speed towards (dx, dy, dz), in 1/128 of the unit of the vertices; dz points along the probe's
 * axis to the pole. The vector's length does not matter; one whose longest component is 2048 or
 * more says the direction well, that is to 1/128 of a triangle with M = 16. Any context.
 *
 * Against the map itself, measured every 10° of azimuth and 30° or 40° of β on a seat of three
 * contacts: within 19 % of V_r with M = 8, 10 % with M = 16, 5 % with M = 32; 2.5, 1 and 0.5 % in
 * the root of the mean square. The worst are the sharp edges between two lobes, which are cut off.
 * On an ATmega at most 400 cycles for M up to 16, 420 for M = 32, call and return included.
 */
uint16_t pretravel_lookup(const pretravel_lookup_t *lookup, int16_t dx, int16_t dy, int16_t dz);

#ifdef __cplusplus
}
#endif

#endif
