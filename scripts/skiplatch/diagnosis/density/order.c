#include "diagnosis/density/order.h"

#include <stdlib.h>

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

double order_kth(double *values, int64_t n, int64_t k)
{
    int64_t low = 0;
    int64_t high = n - 1;
    while (low < high) {
        double  pivot = values[k];
        int64_t up = low;
        int64_t down = high;
        while (up <= down) {
            while (values[up] < pivot) {
                ++up;
            }
            while (pivot < values[down]) {
                --down;
            }
            if (up <= down) {
                swap(&values[up++], &values[down--]);
            }
        }
        low = down < k ? up : low;
        high = k < up ? down : high;
    }
    return values[k];
}

static int compare(const void *one, const void *other)
{
    double a = *(const double *)one;
    double b = *(const double *)other;
    return (a > b) - (a < b);
}

void order_sort(double *values, uint64_t n)
{
    qsort(values, n, sizeof *values, compare);
}

double order_median(double *values, int64_t n)
{
    double upper = order_kth(values, n, n / 2);
    return n % 2 != 0 ? upper : 0.5 * (upper + order_kth(values, n / 2, n / 2 - 1));
}
