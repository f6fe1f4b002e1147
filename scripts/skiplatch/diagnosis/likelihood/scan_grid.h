/* The grid of scans that stamps lie on, whose phase is taken from the stamps themselves. */
#ifndef DIAGNOSIS_SCAN_GRID_H
#define DIAGNOSIS_SCAN_GRID_H

#include "diagnosis/likelihood/physics.h"

/* Give the law of stamps off the grid of the scans, the same for all of a member, count > 0;
 * neither slack nor widening is in it. */
sim_law_t grid_law(const sim_touches_t *of, const sim_member_t *member);

/*
 * Add to values[n] how much likelier each stamp of a member is for the grid, whose phase is chosen
 * to fit best. A factor on the density of the wait, which knows nothing of the grid: 1 for stamps
 * anywhere. 0, or -1 if there is no memory.
 */
int weigh_grid(const sim_touches_t *of, const sim_member_t *member, double *values);

#endif
