#include "law.h"

#include <math.h>
#include <stdbool.h>

#include "angle.h"

#define CONTAMINATION 1e-3 /* share of residuals that may lie anywhere */
#define SHORT         0.3  /* mean of an exponential, over the boxes' scatter, that leaves them */
#define THIN          0.1  /* width of a box, over the Gaussian, that only adds to the Gaussian */
#define BOX_VARIANCE  12.0 /* squared width over variance */
#define SQRT_2        1.4142135623730951
#define SQRT_2_PI     2.5066282746310002
#define NO_TAIL       12.0    /* sigmas beyond which what is left of a Gaussian changes no sum */
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

/* Density at x of U(0, box_a) + U(0, box_b) + N(0, sigma), sigma > 0. */
static double boxes_gauss(double x, double sigma, double box_a, double box_b)
{
    double narrow = fmin(box_a, box_b);
    double wide = fmax(box_a, box_b);
    if (narrow >= THIN * sigma) {
        return trapezoid_gauss(x, sigma, narrow, wide);
    }
    sigma = sqrt(square(sigma) + square(narrow) / BOX_VARIANCE);
    x -= narrow / 2.0;
    if (wide >= THIN * sigma) {
        return box_gauss(x, sigma, wide);
    }
    sigma = sqrt(square(sigma) + square(wide) / BOX_VARIANCE);
    return standard_normal((x - wide / 2.0) / sigma) / sigma;
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

/* Density at x of N(0, sigma) plus an exponential, both > 0. */
static double exponential_gauss(double x, double sigma, double mean)
{
    double ratio = sigma / mean;
    double z = x / sigma - ratio;
    if (z < ASYMPTOTIC) { /* growing and falling factors cancel: left out */
        return standard_normal(x / sigma) * tail_ratio(z) / mean;
    }
    return exp(0.5 * square(ratio) - x / mean + log(standard_normal_below(z))) / mean;
}

static double plain(const sim_law_t *law, double x, double resolution)
{
    return boxes_gauss(x, sqrt(square(law->sigma) + square(resolution)), law->box_a, law->box_b);
}

/* The law of those residuals that get the extra, without its own box and exponential. */
static sim_law_t law_with(const sim_law_t *law, const sim_extra_t *extra)
{
    return (sim_law_t){
        .offset = law->offset + extra->offset,
        .sigma = sqrt(square(law->sigma) + square(extra->sigma)),
        .box_a = law->box_a * (1.0 - extra->boxless),
        .box_b = law->box_b,
    };
}

/* Three boxes and an exponential that is short enough to be part of the Gaussian. */
static double with_boxes(const sim_law_t *law, const sim_extra_t *extra, double x,
                         double resolution)
{
    double narrow = fmin(law->box_a, law->box_b);
    double wide = fmax(law->box_a, law->box_b);
    double narrowest = fmin(narrow, extra->width);
    double variance = square(law->sigma) + square(extra->mean) + square(narrowest) / BOX_VARIANCE;
    sim_law_t sum = {
        .sigma = sqrt(variance),
        .box_a = fmin(wide, fmax(narrow, extra->width)),
        .box_b = fmax(wide, extra->width),
    };
    return plain(&sum, x - extra->mean - narrowest / 2.0, resolution);
}

static double with_exponential(const sim_law_t *law, const sim_extra_t *extra, double x,
                               double resolution)
{
    double boxes = square(law->box_a) + square(law->box_b) + square(extra->width);
    double sigma = sqrt(square(law->sigma) + square(resolution) + boxes / BOX_VARIANCE);
    double middle = (law->box_a + law->box_b + extra->width) / 2.0;
    return exponential_gauss(x - middle, sigma, fmax(extra->mean, resolution));
}

static bool is_long(const sim_law_t *laws, const sim_extra_t *extras, uint64_t n)
{
    for (uint64_t i = 0; i < n; ++i) {
        sim_law_t law = law_with(&laws[i], &extras[i]);
        double    boxes = sqrt((square(law.box_a) + square(law.box_b)) / BOX_VARIANCE);
        if (extras[i].mean > SHORT * boxes) {
            return true;
        }
    }
    return false;
}

/* Add to the densities what one extra makes of them, and take away its share of the plain ones. */
static void add_extra(const double *residuals, const sim_law_t *laws, uint64_t n,
                      const sim_extra_t *extras, double resolution, double *densities)
{
    bool is_exponential = is_long(laws, extras, n);
    for (uint64_t i = 0; i < n; ++i) {
        sim_law_t law = law_with(&laws[i], &extras[i]);
        double    x = residuals[i] - law.offset;
        double    density = is_exponential ? with_exponential(&law, &extras[i], x, resolution)
                                           : with_boxes(&law, &extras[i], x, resolution);
        densities[i] += extras[i].share * density;
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
        log_densities[i] = left * plain(&laws[i], residuals[i] - laws[i].offset, resolution);
    }
    for (uint32_t k = 0; k < extra_count; ++k) {
        add_extra(residuals, laws, n, &extras[k * n], resolution, log_densities);
    }
    for (uint64_t i = 0; i < n; ++i) {
        double anywhere = cauchy(residuals[i], reach);
        log_densities[i] = log((1.0 - CONTAMINATION) * log_densities[i] + CONTAMINATION * anywhere);
    }
}
