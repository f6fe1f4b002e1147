/* Statistical verdicts, each with less than one false alarm in a million (and the seeds are fixed).
 */
#ifndef SUPPORT_STATISTICS_H
#define SUPPORT_STATISTICS_H

#include <stddef.h>

/* Fail unless the values are distributed uniformly in [0, 1) (Kolmogorov-Smirnov). Sorts them. */
void statistics_check_uniform(double *values, size_t n);

/* Fail unless they are distributed normally with mean 0 and standard deviation 1. Sorts them. */
void statistics_check_normal(double *values, size_t n);

/* Fail if the pairs are correlated. */
void statistics_check_independent(const double *a, const double *b, size_t n);

#endif
