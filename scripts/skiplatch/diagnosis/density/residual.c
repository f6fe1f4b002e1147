#include "diagnosis/density/residual.h"

#include <math.h>

#include "angle.h"

#define CONTAMINATION 1e-3 /* share of residuals that may lie anywhere */

static sum_t plain(const sim_law_t *law, double resolution)
{
    return (sum_t){
        .middle = law->offset,
        .sigma = sqrt(square(law->sigma) + square(resolution)),
        .narrow = lesser(law->box_a, law->box_b),
        .wide = greater(law->box_a, law->box_b),
    };
}

/* The law of those residuals that get the extra. */
static sum_t with_extra(const sim_law_t *law, const sim_extra_t *extra, double resolution)
{
    double box_a = law->box_a * (1.0 - extra->boxless);
    double narrow = lesser(box_a, law->box_b);
    double wide = greater(box_a, law->box_b);
    double narrowest = lesser(narrow, extra->width);
    sum_t  sum = {
        .middle = law->offset + extra->offset,
        .sigma = sqrt(square(law->sigma) + square(extra->sigma) + square(resolution)),
        .narrow = lesser(wide, greater(narrow, extra->width)),
        .wide = greater(wide, extra->width),
        .mean = extra->mean,
    };
    sum_fold_box(&sum, &narrowest);
    return sum;
}

/* Share that gets no extra of residual i. */
static double share_left(const sim_extra_t *extras, uint64_t n, uint32_t extra_count, uint64_t i)
{
    double left = 1.0;
    for (uint32_t k = 0; k < extra_count; ++k) {
        left -= extras[k * n + i].share;
    }
    return left;
}

residual_part_t residual_part(const sim_residuals_t *of, uint64_t i, uint32_t k)
{
    residual_part_t part;
    if (k == 0u) {
        part.share = share_left(of->extras, of->n, of->extra_count, i);
        part.sum = plain(&of->laws[i], of->resolution);
    } else {
        const sim_extra_t *extra = &of->extras[(k - 1u) * of->n + i];
        part.share = extra->share;
        part.sum = with_extra(&of->laws[i], extra, of->resolution);
    }
    sum_fold_thin(&part.sum);
    return part;
}

double residual_part_density(const residual_part_t *part, double x)
{
    return fabs(part->share) <= 0.0 ? 0.0 : part->share * sum_density(&part->sum, x);
}

/* Mean and variance of what all n parts of a residual add up to. */
static moments_t moments_of(const residual_part_t *parts, uint64_t n)
{
    double mean = 0.0;
    double variance = 0.0;
    for (uint64_t k = 0; k < n; ++k) {
        mean += parts[k].share * sum_mean(&parts[k].sum);
    }
    for (uint64_t k = 0; k < n; ++k) {
        double off = sum_mean(&parts[k].sum) - mean;
        variance += parts[k].share * (sum_variance(&parts[k].sum) + square(off));
    }
    return (moments_t){.mean = mean, .variance = variance};
}

moments_t residual_law_moments(const sim_residuals_t *of, uint64_t i, residual_part_t *room)
{
    for (uint32_t k = 0; k <= of->extra_count; ++k) {
        room[k] = residual_part(of, i, k);
    }
    return moments_of(room, of->extra_count + (uint64_t)1);
}

static double cauchy(double x, double width)
{
    return 1.0 / (PI * width * (1.0 + square(x / width)));
}

double residual_density(double density, double x, double reach)
{
    return (1.0 - CONTAMINATION) * density + CONTAMINATION * cauchy(x, reach);
}

double residual_parts_density(const residual_part_t *parts, uint64_t n, double x, double reach)
{
    double density = 0.0;
    for (uint64_t k = 0; k < n; ++k) {
        density += residual_part_density(&parts[k], x);
    }
    return residual_density(density, x, reach);
}
