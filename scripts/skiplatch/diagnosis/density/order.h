/* Values by their order. */
#ifndef DIAGNOSIS_ORDER_H
#define DIAGNOSIS_ORDER_H

#include <stdint.h>

/* Bring the k-th of n values to its place, with none that is greater before it and none that is
 * smaller behind (Hoare, Communications of the ACM 4 (1961) 321), and give it. */
double order_kth(double *values, int64_t n, int64_t k);

/* Bring n values into their order. */
void order_sort(double *values, uint64_t n);

/* Median of n > 0 values, whose order is lost. */
double order_median(double *values, int64_t n);

#endif
