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

enum {
    PRETRAVEL_DIVISIONS_MAX = 32, /* M: 2113 vertices */
    PRETRAVEL_SPEED_MAX = 0x7FFF, /* of a vertex, in units of the table */
    PRETRAVEL_NO_SPEED = 0        /* for a direction that is none, or below the equator */
};

typedef struct {
    const uint16_t *speed;     /* 2·M² + 2·M + 1 vertices, in a unit that whoever made them says */
    uint8_t         divisions; /* M, 1 … PRETRAVEL_DIVISIONS_MAX */
} pretravel_lookup_t;

/*
 * Speed towards (dx, dy, dz), in units of the table, within one unit of what the vertices say; dz
 * points along the probe's axis to the pole. The vector's length does not matter, but a component
 * is read to 13 bits at most, so a longest one of 8192 or more says the direction best. Any
 * context.
 */
uint16_t pretravel_lookup(const pretravel_lookup_t *lookup, int16_t dx, int16_t dy, int16_t dz);

#endif
