#include "diagnosis/density/residual.h"

#include <math.h>

#include "angle.h"
#include "diagnosis/density/sum.h"

#define CONTAMINATION 1e-3 /* share of residuals that may lie anywhere */

static double plain(const sim_law_t *law, double x, double resolution)
{
    return sum_density(
        (sum_t){
            .middle = law->offset,
            .sigma = sqrt(square(law->sigma) + square(resolution)),
            .narrow = fmin(law->box_a, law->box_b),
            .wide = fmax(law->box_a, law->box_b),
        },
        x);
}

/* The law of those residuals that get the extra. */
static double with_extra(const sim_law_t *law, const sim_extra_t *extra, double x,
                         double resolution)
{
    double box_a = law->box_a * (1.0 - extra->boxless);
    double narrow = fmin(box_a, law->box_b);
    double wide = fmax(box_a, law->box_b);
    double narrowest = fmin(narrow, extra->width);
    sum_t  sum = {
        .middle = law->offset + extra->offset,
        .sigma = sqrt(square(law->sigma) + square(extra->sigma) + square(resolution)),
        .narrow = fmin(wide, fmax(narrow, extra->width)),
        .wide = fmax(wide, extra->width),
        .mean = extra->mean,
    };
    sum_fold_box(&sum, &narrowest);
    return sum_density(sum, x);
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

static double cauchy(double x, double width)
{
    return 1.0 / (PI * width * (1.0 + square(x / width)));
}

double residual_log_density(const sim_residuals_t *of, uint64_t i, double moved)
{
    double x = of->residuals[i] - moved;
    double sum =
        share_left(of->extras, of->n, of->extra_count, i) * plain(&of->laws[i], x, of->resolution);
    for (uint32_t k = 0; k < of->extra_count; ++k) {
        const sim_extra_t *extra = &of->extras[k * of->n + i];
        if (extra->share > 0.0) {
            sum += extra->share * with_extra(&of->laws[i], extra, x, of->resolution);
        }
    }
    return log((1.0 - CONTAMINATION) * sum + CONTAMINATION * cauchy(x, of->reach[i]));
}
