#include "statistics.h"

#include <math.h>
#include <stdlib.h>

#include "unity.h"

#define ALPHA     1e-6
#define DEVIATION 5.0 /* a normal quantity is so far off less often than ALPHA */

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The values are turned into what has to be uniform already. The limit is Kolmogorov's for large n.
 */
static void check_distance(double *values, size_t n)
{
    double widest = 0.0;
    qsort(values, n, sizeof *values, compare);
    for (size_t i = 0u; i < n; ++i) {
        double below = values[i] - (double)i / (double)n;
        widest = fmax(widest, fmax(below, 1.0 / (double)n - below));
    }
    double limit = sqrt(-0.5 * log(ALPHA / 2.0) / (double)n);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(limit, 0.0, widest, "not so distributed");
}

void statistics_check_uniform(double *values, size_t n)
{
    for (size_t i = 0u; i < n; ++i) {
        TEST_ASSERT_TRUE_MESSAGE(values[i] >= 0.0 && values[i] < 1.0, "out of range");
    }
    check_distance(values, n);
}

void statistics_check_normal(double *values, size_t n)
{
    for (size_t i = 0u; i < n; ++i) {
        values[i] = 0.5 * erfc(-values[i] / sqrt(2.0));
    }
    check_distance(values, n);
}

static double mean(const double *values, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0u; i < n; ++i) {
        sum += values[i];
    }
    return sum / (double)n;
}

void statistics_check_independent(const double *a, const double *b, size_t n)
{
    double mean_a = mean(a, n);
    double mean_b = mean(b, n);
    double aa = 0.0;
    double bb = 0.0;
    double ab = 0.0;
    for (size_t i = 0u; i < n; ++i) {
        aa += (a[i] - mean_a) * (a[i] - mean_a);
        bb += (b[i] - mean_b) * (b[i] - mean_b);
        ab += (a[i] - mean_a) * (b[i] - mean_b);
    }
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(DEVIATION / sqrt((double)n), 0.0, ab / sqrt(aa * bb),
                                      "correlated");
}
