#include "law.h"

#include <math.h>

#include "angle.h"

#define CONTAMINATION 1e-3 /* share of residuals that may lie anywhere */
#define THIN          0.1  /* what a box or an exponential, over the Gaussian, only adds to it */
#define SHORTEST      1e-4 /* width of a box, over the exponential, whose edges are not resolved */
#define BOX_VARIANCE  12.0 /* squared width over variance */
#define SQRT_2        1.4142135623730951
#define SQRT_2_PI     2.5066282746310002
#define NO_TAIL       12.0    /* sigmas beyond which what is left of a Gaussian changes no sum */
#define NOTHING       (-40.0) /* sigmas from which down a Gaussian is 0 in any sum */
#define ASYMPTOTIC    (-20.0) /* sigmas from which down the series of the tail is exact */

static double square(double x)
{
    return x * x;
}

static double standard_normal(double z)
{
    return exp(-0.5 * square(z)) / SQRT_2_PI;
}

static double standard_normal_below(double z)
{
    return 0.5 * erfc(-z / SQRT_2);
}

/* Integral of the Gaussian's distribution function up to -|x|: how a corner at 0 is rounded off. */
static double rounding(double x, double sigma)
{
    double z = fabs(x) / sigma;
    if (z > NO_TAIL) {
        return 0.0;
    }
    return sigma * (standard_normal(z) - z * standard_normal_below(-z));
}

static double box_gauss(double x, double sigma, double box)
{
    double from_edge = fmin(x, box - x); /* of two equal values the one without cancellation */
    double inside = standard_normal_below(from_edge / sigma);
    return (inside - standard_normal_below((from_edge - box) / sigma)) / box;
}

/* A trapezoid whose four corners the Gaussian rounds off. */
static double trapezoid_gauss(double x, double sigma, double narrow, double wide)
{
    double from_edge = fmin(x, narrow + wide - x);
    double sharp = fmax(0.0, fmin(from_edge, narrow));
    double corners = rounding(from_edge, sigma) - rounding(from_edge - narrow, sigma) -
                     rounding(from_edge - wide, sigma) + rounding(from_edge - narrow - wide, sigma);
    return fmax(0.0, (sharp + corners) / (narrow * wide));
}

/* What is below z, far down, over the density at z. */
static double tail_ratio(double z)
{
    double term = 1.0;
    double sum = 1.0;
    for (int k = 1; k <= 15; k += 2) {
        term *= -k / square(z);
        sum += term;
    }
    return sum / -z;
}

/* Density at x of N(0, sigma) plus an exponential, both > 0 and not too far apart. */
static double exponential_gauss(double x, double sigma, double mean)
{
    double ratio = sigma / mean;
    double z = x / sigma - ratio;
    if (x < NOTHING * sigma) {
        return 0.0;
    }
    if (z < ASYMPTOTIC) { /* growing and falling factors cancel: left out */
        return standard_normal(x / sigma) * tail_ratio(z) / mean;
    }
    double below = z > NO_TAIL ? 1.0 : standard_normal_below(z);
    return exp(0.5 * square(ratio) - x / mean) * below / mean;
}

/*
 * An exponential makes of a density p the density q = p - mean * q', and what a box makes of
 * anything has the difference of that thing over the box for a slope.
 */
static double box_exponential(double x, double sigma, double box, double mean)
{
    double rise = exponential_gauss(x, sigma, mean) - exponential_gauss(x - box, sigma, mean);
    return box_gauss(x, sigma, box) - mean / box * rise;
}

static double trapezoid_exponential(double x, double sigma, double narrow, double wide, double mean)
{
    double rise =
        box_exponential(x, sigma, wide, mean) - box_exponential(x - narrow, sigma, wide, mean);
    return trapezoid_gauss(x, sigma, narrow, wide) - mean / narrow * rise;
}

/* A Gaussian about `middle`, two boxes from 0 and an exponential; 0 is what is not there. */
typedef struct {
    double middle;
    double sigma;
    double narrow;
    double wide;
    double mean;
} sum_t;

static void fold(sum_t *sum, double *part, double middle, double variance)
{
    sum->middle += middle;
    sum->sigma = sqrt(square(sum->sigma) + variance);
    *part = 0.0;
}

static void fold_box(sum_t *sum, double *box)
{
    fold(sum, box, *box / 2.0, square(*box) / BOX_VARIANCE);
}

/* Make what is too thin to have a shape of its own a part of the Gaussian. */
static void fold_thin(sum_t *sum)
{
    if (sum->narrow < fmax(THIN * sum->sigma, SHORTEST * sum->mean)) {
        fold_box(sum, &sum->narrow);
    }
    if (sum->wide < fmax(THIN * sum->sigma, SHORTEST * sum->mean)) {
        fold_box(sum, &sum->wide);
    }
    if (sum->mean < THIN * sum->sigma) {
        fold(sum, &sum->mean, sum->mean, square(sum->mean));
    }
}

static double without_exponential(const sum_t *sum, double x)
{
    if (sum->narrow > 0.0) {
        return trapezoid_gauss(x, sum->sigma, sum->narrow, sum->wide);
    }
    if (sum->wide > 0.0) {
        return box_gauss(x, sum->sigma, sum->wide);
    }
    return standard_normal(x / sum->sigma) / sum->sigma;
}

static double with_exponential(const sum_t *sum, double x)
{
    if (sum->narrow > 0.0) {
        return trapezoid_exponential(x, sum->sigma, sum->narrow, sum->wide, sum->mean);
    }
    if (sum->wide > 0.0) {
        return box_exponential(x, sum->sigma, sum->wide, sum->mean);
    }
    return exponential_gauss(x, sum->sigma, sum->mean);
}

static double density(sum_t sum, double x)
{
    fold_thin(&sum);
    x -= sum.middle;
    return sum.mean > 0.0 ? fmax(0.0, with_exponential(&sum, x)) : without_exponential(&sum, x);
}

static double plain(const sim_law_t *law, double x, double resolution)
{
    return density(
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
    fold_box(&sum, &narrowest);
    return density(sum, x);
}

/* Add to the densities what one extra makes of them. */
static void add_extra(const double *residuals, const sim_law_t *laws, uint64_t n,
                      const sim_extra_t *extras, double resolution, double *densities)
{
    for (uint64_t i = 0; i < n; ++i) {
        densities[i] +=
            extras[i].share * with_extra(&laws[i], &extras[i], residuals[i], resolution);
    }
}

/* Share of the residuals that get no extra. */
static double share_left(const sim_extra_t *extras, uint64_t n, uint32_t extra_count)
{
    double left = 1.0;
    for (uint32_t k = 0; k < extra_count; ++k) {
        left -= extras[k * n].share;
    }
    return left;
}

static double cauchy(double x, double width)
{
    return 1.0 / (PI * width * (1.0 + square(x / width)));
}

void sim_law_log_density(const double *residuals, const sim_law_t *laws, uint64_t n,
                         const sim_extra_t *extras, uint32_t extra_count, double reach,
                         double resolution, double *log_densities)
{
    double left = n > 0 ? share_left(extras, n, extra_count) : 1.0;
    for (uint64_t i = 0; i < n; ++i) {
        log_densities[i] = left * plain(&laws[i], residuals[i], resolution);
    }
    for (uint32_t k = 0; k < extra_count; ++k) {
        add_extra(residuals, laws, n, &extras[k * n], resolution, log_densities);
    }
    for (uint64_t i = 0; i < n; ++i) {
        double anywhere = cauchy(residuals[i], reach);
        log_densities[i] = log((1.0 - CONTAMINATION) * log_densities[i] + CONTAMINATION * anywhere);
    }
}
