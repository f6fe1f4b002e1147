/* Lays a map of speeds out as the vertices that the controller's lookup wants. Task level. */
#ifndef COMP_PRETRAVEL_GRID_H
#define COMP_PRETRAVEL_GRID_H

#include <stdint.h>

#include "comp/pretravel_lookup.h"
#include "comp/pretravel_map.h"

/* Vertices of a table: 2·M² + 2·M + 1, M = 2^level: 145 for level 3, 545 for level 4. */
uint32_t pretravel_grid_size(uint8_t level);

/*
 * Fill `vertices` (pretravel_grid_size(level) of them) with the speeds of a checked map, one a
 * cell, in units of `unit_mm_min` > 0, to the nearest unit.
 * Errors: DIRECTION (no such level), SCALE (a speed that is below 1 or above PRETRAVEL_SPEED_MAX
 * units), LIMIT (unit), NOT_FINITE.
 */
int pretravel_grid_build(const pretravel_cell_t *cells, const double *speed_mm_min, uint32_t count,
                         uint8_t level, double unit_mm_min, uint16_t *vertices);

#endif
