/*
 * Densities, in closed form, of what a chain adds up to: an offset, two boxes from 0, a Gaussian,
 * and what a share of the touches gets on top. Python reads this header too: no more of the
 * preprocessor than what can be left out.
 */
#ifndef SIM_LAW_H
#define SIM_LAW_H

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

/*
 * Write the logarithm of the density of each of n residuals under its own law and `extra_count`
 * extras, extras[extra][residual], of the same share for all residuals. One residual in a thousand
 * may lie anywhere, over a width of about `reach` (> 0). Scatter below `resolution` (> 0) is not
 * resolved.
 *
 * A box or an exponential of less than a tenth of the scatter, a box of less than a ten-thousandth
 * of the exponential, and the narrowest of three boxes count by mean and variance alone.
 */
void sim_law_log_density(const double *residuals, const sim_law_t *laws, uint64_t n,
                         const sim_extra_t *extras, uint32_t extra_count, double reach,
                         double resolution, double *log_densities);

#pragma GCC visibility pop

#endif
