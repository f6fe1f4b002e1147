#include "diagnosis/density/guess.h"

#include <math.h>

#include "diagnosis/density/order.h"

/* Standard deviations beyond which a touch pulls a guess no further, or, where laws have several
 * peaks, not at all. */
#define CALM  2.0
#define DENSE 0.25  /* share of the residuals whose shortest stretch is about a peak */
#define MANY  0.25  /* share of residuals beyond that which no law leaves there */
#define TINY  1e-12 /* of what a group is known by, if nothing tells of it */

/* Keep the values that are known to a width of no more than the middle one; give their number. */
static int64_t keep_known(const double *values, const double *widths, int64_t n, double *kept)
{
    for (int64_t i = 0; i < n; ++i) {
        kept[i] = widths[i];
    }
    double  usual = order_median(kept, n);
    int64_t count = 0;
    for (int64_t i = 0; i < n; ++i) {
        if (widths[i] <= usual) {
            kept[count++] = values[i];
        }
    }
    return count;
}

/* Middle of the shortest stretch that has a fair part of n > 0 values, whose order is lost. */
static double densest(double *values, int64_t n)
{
    order_sort(values, (uint64_t)n);
    int64_t across = (int64_t)(DENSE * (double)(n - 1));
    int64_t best = 0;
    for (int64_t i = 1; i + across < n; ++i) {
        if (values[i + across] - values[i] < values[best + across] - values[best]) {
            best = i;
        }
    }
    return 0.5 * (values[best + across / 2] + values[best + (across + 1) / 2]);
}

/* The part of a law that has its highest peak: few touches are near the mean of all parts. */
static const sum_t *highest_peak(const residual_part_t *parts, uint64_t part_count)
{
    const sum_t *found = &parts->sum;
    double       most = 0.0;
    for (uint64_t k = 0; k < part_count; ++k) {
        double height = square(parts[k].share) / sum_variance(&parts[k].sum);
        if (height > most) {
            most = height;
            found = &parts[k].sum;
        }
    }
    return found;
}

guess_t guess_length(const sim_residuals_t *of, const residual_part_t *parts,
                     const sim_datum_t *datum, const uint64_t *members, uint64_t count,
                     double *work)
{
    const uint64_t part_count = of->extra_count + (uint64_t)1;
    const bool     is_mixture = part_count > 1u;
    double        *off = work;
    double        *widths = work + count;
    for (uint64_t k = 0; k < count; ++k) {
        uint64_t     i = members[k];
        const sum_t *peak = highest_peak(&parts[i * part_count], part_count);
        off[k] = (of->residuals[i] - sum_mean(peak)) / datum->per_length[i];
        widths[k] = sqrt(sum_variance(peak)) / fabs(datum->per_length[i]);
    }
    double about = 0.0;
    if (count > 0u) {
        double *kept = widths + count;
        int64_t known = keep_known(off, widths, (int64_t)count, kept);
        about = is_mixture ? densest(kept, known) : order_median(kept, known);
    }
    double told = 0.0;
    double pull = 0.0;
    double beyond = 0.0;
    for (uint64_t k = 0; k < count; ++k) {
        double deviations = (off[k] - about) / widths[k];
        bool   is_beyond = fabs(deviations) > CALM;
        double calm = is_mixture ? 0.0 : copysign(CALM, deviations);
        told += 1.0 / square(widths[k]);
        pull += (is_beyond ? calm : deviations) / widths[k];
        beyond += is_beyond ? 1.0 : 0.0;
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
