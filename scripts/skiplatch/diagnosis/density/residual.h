/* How likely one residual is under its law and its extras. Behind law.h; nobody else uses it. */
#ifndef DIAGNOSIS_RESIDUAL_H
#define DIAGNOSIS_RESIDUAL_H

#include <stdint.h>

#include "diagnosis/density/law.h"
#include "diagnosis/density/sum.h"

/* What a share of the touches has for a law: no extra, or one of them. */
typedef struct {
    double share;
    sum_t  sum;
} residual_part_t;

/* Mean and variance of a law. */
typedef struct {
    double mean;
    double variance;
} moments_t;

/* Give part k of residual i: without an extra for 0, with extra k - 1 for others. */
residual_part_t residual_part(const sim_residuals_t *of, uint64_t i, uint32_t k);

/* What a part adds to the density at x. */
double residual_part_density(const residual_part_t *part, double x);

/* Mean and variance of what all parts of residual i add up to; `room` for these: one, and one for
 * each extra. */
moments_t residual_law_moments(const sim_residuals_t *of, uint64_t i, residual_part_t *room);

/* A density at x, if one in a thousand residuals may lie within `reach`. */
double residual_density(double density, double x, double reach);

/* The same of what n parts add up to. */
double residual_parts_density(const residual_part_t *parts, uint64_t n, double x, double reach);

#endif
