/* Where the search for a datum begins, and how far its steps go. Only datum.c uses it. */
#ifndef DIAGNOSIS_GUESS_H
#define DIAGNOSIS_GUESS_H

#include <stdbool.h>
#include <stdint.h>

#include "diagnosis/density/law.h"
#include "diagnosis/density/residual.h"

#define GUESS_ROOM 3u /* values a residual that `work` has room for */

/* What is known of a length beforehand. */
typedef struct {
    double length;
    double step;      /* standard deviation that it is known to, > 0 */
    bool   is_spread; /* residuals are off each other by far more than their laws allow */
} guess_t;

/*
 * Guess the length of a group by those of its residuals that tell most of it.
 *
 * parts: of each residual in turn. members: numbers of those in the group; count, which may be 0.
 * work: holds the length that each of them asks for afterwards, count values.
 */
guess_t guess_length(const sim_residuals_t *of, const residual_part_t *parts,
                     const sim_datum_t *datum, const uint64_t *members, uint64_t count,
                     double *work);

/* Give the length that a share of those asked for is below, 0 ≤ share < 1; their order is lost. */
double guess_quantile(double *work, uint64_t count, double share);

#endif
