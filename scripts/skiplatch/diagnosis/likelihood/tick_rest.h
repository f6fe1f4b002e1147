/* Positions that are off together, because scans are stamped early by a rest of a tick. */
#ifndef DIAGNOSIS_TICK_REST_H
#define DIAGNOSIS_TICK_REST_H

#include "diagnosis/likelihood/physics.h"

/*
 * Take from the residuals of a member, laid out from number `begin` on, by how much they are off
 * for that. 0, or -1 if there is no memory.
 *
 * Where the scan period is a whole number of ticks, the rest is the same for all scans, and no
 * scatter. The touches say how large it is, half a tick at the most.
 */
int take_tick_rest(const sim_touches_t *of, const sim_member_t *member,
                   const sim_residuals_t *laid_out, uint64_t begin, double *residuals);

#endif
