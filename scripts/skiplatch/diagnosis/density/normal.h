/* The standard normal law by a table: as exact as sums of densities need it, without exp or erfc.
 */
#ifndef DIAGNOSIS_NORMAL_H
#define DIAGNOSIS_NORMAL_H

#define NORMAL_END 9.0 /* from which on nothing is left beside what is greater */

/* Density at z. */
double normal_density(double z);

/* Share below z, -NORMAL_END < z < NORMAL_END; to 1e-15, and far below 0 to 2e-10 of itself. */
double normal_below(double z);

/* Integral of the share up to -z, 0 ≤ z < NORMAL_END: how a corner at 0 is rounded off. */
double normal_rounding(double z);

#endif
