/* Lays a map of speeds out as the vertices that the controller's lookup wants. Task level. */
#ifndef COMP_PRETRAVEL_GRID_H
#define COMP_PRETRAVEL_GRID_H

#include <stdint.h>

#include "comp/pretravel_lookup.h"
#include "comp/pretravel_map.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Vertices of a table: 2·M² + 2·M + 1; 145 for M = 8, 545 for M = 16. */
uint32_t pretravel_grid_size(uint8_t divisions);

/*
 * Fill `vertices` (pretravel_grid_size() of them) with the speeds of a map without gaps, one a
 * cell, in units of `unit_mm_min` > 0, to the nearest unit; none is outside of the map's own range.
 * Where the map does not reach, see pretravel_map_at(). After an error nothing is written.
 * Errors: DIVISIONS, LIMIT (unit), SCALE: a speed that is not finite, rounds to 0 units, or to more
 * than PRETRAVEL_VERTEX_MAX.
 */
int pretravel_grid_build(const pretravel_cell_t *cells, const double *speed_mm_min, uint32_t count,
                         uint8_t divisions, double unit_mm_min, uint8_t *vertices);

#ifdef __cplusplus
}
#endif

#endif
