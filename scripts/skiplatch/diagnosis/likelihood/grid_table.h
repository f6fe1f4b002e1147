/* The density of stamps off the grid of the scans, tabulated over one period. Behind scan_grid.h.
 */
#ifndef DIAGNOSIS_GRID_TABLE_H
#define DIAGNOSIS_GRID_TABLE_H

#include <stdint.h>

#include "diagnosis/density/law.h"

/* Logarithms of the density times the period, at places in their order. */
typedef struct {
    double  *where;
    double  *logs;
    uint64_t n;
    double   period;
    uint64_t bins; /* phases of late scans that are tried: a tick apart, if not too many */
} grid_table_t;

/*
 * Tabulate a law with its extras, fine at its edges and within some ticks of 0. 0, or -1 if there
 * is no memory. A table has to be released.
 */
int make_table(grid_table_t *table, const sim_law_t *law, const sim_extra_t *extras,
               uint32_t extra_count, double tick, double resolution, double period);

void release_table(grid_table_t *table);

/* The value at a place within half a period of 0. `at` is 0 or what the last call left there, which
 * is soonest for places that rise. */
double table_value(const grid_table_t *table, double place, uint64_t *at);

/* How many doubles table_phase needs. */
uint64_t phase_room(const grid_table_t *table);

/* Give the likeliest of so many phases, for stamps as shares of the period: n of them, in [0, 1).
 */
double table_phase(const grid_table_t *table, const double *turns, uint64_t n, double *room);

#endif
