/* How likely recorded touches are under a change of the physics. */
#ifndef DIAGNOSIS_STREAMS_H
#define DIAGNOSIS_STREAMS_H

#include "diagnosis/likelihood/physics.h"

/* Streams that one length shifts together: stamps tell when the surface is met, coordinates where.
 */
enum sim_family { SIM_BY_STAMPS, SIM_BY_COORDINATES, SIM_WITHOUT_STAMPS, SIM_FAMILY_COUNT };

#pragma GCC visibility push(default)

/*
 * Add the log-likelihood of each touch of some members to values[stream][n], and write the
 * likeliest datum of each group, by the members of each family, to found[family][datum_count];
 * nothing of a family without any. 0, or -1 if there is no memory.
 */
int sim_streams_log_likelihood(const sim_touches_t *of, const sim_member_t *members,
                               uint32_t member_count, double *values, double *found);

#pragma GCC visibility pop

#endif
