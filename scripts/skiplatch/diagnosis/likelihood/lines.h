/* What values on the lines of a coarse grid add to their likelihood. */
#ifndef DIAGNOSIS_LINES_H
#define DIAGNOSIS_LINES_H

#include "diagnosis/likelihood/physics.h"

/* Steps that stamps are rounded to between the lines of a foreign clock from which on stamps show
 * them: closer ones beat with these. */
enum { SIM_LINES_APART = 8 };

#pragma GCC visibility push(default)

/*
 * Write what the lines that a change makes of a stream add to the logarithm of the density of each
 * touch of a member: to bonus[count]. A coarse grid holds all its probability on few values.
 */
void sim_line_bonus(const sim_touches_t *of, const sim_member_t *member, double *bonus);

#pragma GCC visibility pop

#endif
