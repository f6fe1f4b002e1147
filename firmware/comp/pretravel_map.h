/*
 * Map of trigger radii over directions: azimuth α around the probe's axis, β up from the plane
 * across it (0 equator, 90 pole). Readings are repeated; the map has the mean and the scatter.
 *
 * Directions lie on parallels: a row is all azimuths measured at one β. Rows may differ in their
 * azimuths. Directions within 0.001° of each other are one; at the pole every azimuth is the same.
 */
#ifndef COMP_PRETRAVEL_MAP_H
#define COMP_PRETRAVEL_MAP_H

#include <stdint.h>

#include "comp/pretravel.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PRETRAVEL_DIRECTIONS_MIN = 6, /* of a map */
    PRETRAVEL_AZIMUTHS_MIN = 3    /* of a row, but for the pole */
};

/* One direction. */
typedef struct {
    double   alpha_deg;  /* 0 ≤ α < 360; 0 at the pole */
    double   beta_deg;   /* 0 … 90 */
    double   radius_um;  /* mean of the repeats */
    double   scatter_um; /* their standard deviation; NaN of a single one */
    uint32_t runs;       /* how many repeats */
} pretravel_cell_t;

/* Where directions are missing: nothing was measured across `width_deg` after this direction. */
typedef struct {
    double alpha_deg;
    double beta_deg;
    double width_deg; /* in azimuth, or in β between two rows */
} pretravel_gap_t;

/*
 * Sort n readings into cells, ordered by β and then α; `count` becomes how many there are. α is
 * −360 … 360, β is 0 … 90. Readings may come in any order. After an error `count` is the reading
 * that caused it. Task level.
 * Errors: NOT_FINITE, DIRECTION, CAPACITY.
 */
int pretravel_map_build(const double *alpha_deg, const double *beta_deg, const double *radius_um,
                        uint32_t n, pretravel_cell_t *cells, uint32_t capacity, uint32_t *count);

/*
 * Check that nothing is missing within the map: a step of azimuth within a row, or of β between
 * rows, that is more than one and a half times the median step is a gap. How far the map reaches in
 * β is the caller's choice.
 * Errors: FEW_DIRECTIONS, GAP (`gap` says where; else it is unchanged). Task level.
 */
int pretravel_map_check(const pretravel_cell_t *cells, uint32_t count, pretravel_gap_t *gap);

/*
 * Value at any direction: linear in α within a row and in β between rows. `values` has one value a
 * cell: radii, speeds. Below the lowest row it is that row's; from the highest row it goes to that
 * row's mean at the pole. α is any finite angle, β 0 … 90; a map without gaps. Task level.
 */
double pretravel_map_at(const pretravel_cell_t *cells, const double *values, uint32_t count,
                        double alpha_deg, double beta_deg);

#ifdef __cplusplus
}
#endif

#endif
