#include "diagnosis/density/guess.h"

#include <math.h>

#include "diagnosis/density/order.h"

#define CALM 2.0   /* standard deviations beyond which a touch pulls a guess no further */
#define MANY 0.25  /* share of residuals beyond that which no law leaves there */
#define TINY 1e-12 /* of what a group is known by, if nothing tells of it */

/* Middle of values, of those that are known to a width of no more than the middle one. */
static double middle(const double *values, const double *widths, int64_t n, double *work)
{
    for (int64_t i = 0; i < n; ++i) {
        work[i] = widths[i];
    }
    double  usual = order_median(work, n);
    int64_t count = 0;
    for (int64_t i = 0; i < n; ++i) {
        if (widths[i] <= usual) {
            work[count++] = values[i];
        }
    }
    return order_median(work, count);
}

guess_t guess_length(const sim_residuals_t *of, const residual_part_t *parts,
                     const sim_datum_t *datum, const uint64_t *members, uint64_t count,
                     double *work)
{
    const uint64_t part_count = of->extra_count + (uint64_t)1;
    double        *off = work;
    double        *widths = work + count;
    for (uint64_t k = 0; k < count; ++k) {
        uint64_t  i = members[k];
        moments_t law = residual_moments(&parts[i * part_count], part_count);
        off[k] = (of->residuals[i] - law.mean) / datum->per_length[i];
        widths[k] = sqrt(law.variance) / fabs(datum->per_length[i]);
    }
    double about = count == 0u ? 0.0 : middle(off, widths, (int64_t)count, widths + count);
    double told = 0.0;
    double pull = 0.0;
    double beyond = 0.0;
    for (uint64_t k = 0; k < count; ++k) {
        double deviations = (off[k] - about) / widths[k];
        told += 1.0 / square(widths[k]);
        pull += fmin(fmax(deviations, -CALM), CALM) / widths[k];
        beyond += fabs(deviations) > CALM ? 1.0 : 0.0;
    }
    double known = fmax(told + (datum->u > 0.0 ? 1.0 / square(datum->u) : 0.0), TINY);
    double length = (about + pull / fmax(told, TINY)) * told / known;
    return (guess_t){
        .length = length, .step = 1.0 / sqrt(known), .is_spread = beyond > MANY * (double)count};
}

double guess_quantile(double *work, uint64_t count, double share)
{
    return order_kth(work, (int64_t)count, (int64_t)(share * (double)count));
}
