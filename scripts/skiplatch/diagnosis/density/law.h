/*
 * Densities, in closed form, of what a chain adds up to: an offset, two boxes from 0, a Gaussian,
 * and what a share of the touches gets on top. Python reads this header too: no more of the
 * preprocessor than what can be left out.
 */
#ifndef DIAGNOSIS_LAW_H
#define DIAGNOSIS_LAW_H

#include <stdint.h>

#pragma GCC visibility push(default)

/* The law of one residual: offset + U(0, box_a) + U(0, box_b) + N(0, sigma), in one unit, ≥ 0. */
typedef struct {
    double offset; /* of any sign */
    double sigma;
    double box_a;
    double box_b;
} sim_law_t;

/* What a share of the touches gets on top of the law of one residual, in its unit. */
typedef struct {
    double share;
    double offset;  /* of any sign */
    double width;   /* of a box from 0 */
    double mean;    /* of an exponential */
    double sigma;   /* of a Gaussian */
    double boxless; /* 1 if box_a of the law is not there for these touches, else 0 */
} sim_extra_t;

/* Residuals and what is believed of each. Arrays of n, but for extras: [extra_count][n]. */
typedef struct {
    const double      *residuals;
    const sim_law_t   *laws;
    const sim_extra_t *extras;
    const double      *reach; /* width over which a contaminated residual may lie, > 0 */
    uint64_t           n;
    uint32_t           extra_count;
    double             resolution; /* scatter that is not resolved, > 0 */
} sim_residuals_t;

/* Lengths that are not known, each shared by a group of residuals. */
typedef struct {
    const double   *per_length; /* by how much a unit of it moves each residual, not 0; n */
    const uint32_t *groups;     /* whose length moves it; n */
    uint32_t        group_count;
    double          u; /* standard uncertainty of a length about 0; 0 if it may be anything */
} sim_datum_t;

/*
 * Write the logarithm of the density of each residual under its own law and extras. One in a
 * thousand may lie anywhere. Shares of the extras of a residual add up to 1 at the most.
 *
 * A box of less than half of the scatter, a box or an exponential of less than a tenth of it beside
 * each other, a box of less than a ten-thousandth of the exponential, and the narrowest of three
 * boxes count by mean and variance alone.
 */
void sim_law_log_density(const sim_residuals_t *of, double *log_densities);

/*
 * Find the likeliest length of each group, starting from where the residuals that tell most of it
 * say that it is, and from 0 if that is near. Write it to found[group_count], and the logarithms of
 * the densities there to log_densities[n]. 0, or -1 if there is no memory.
 */
int sim_law_at_best_datum(const sim_residuals_t *of, const sim_datum_t *datum, double *found,
                          double *log_densities);

#pragma GCC visibility pop

#endif
