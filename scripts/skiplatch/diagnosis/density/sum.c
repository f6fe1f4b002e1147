#include "diagnosis/density/sum.h"

#include <math.h>
#include <stdbool.h>

#include "diagnosis/density/normal.h"

#define THIN         0.1  /* what a box or an exponential, over the Gaussian, only adds to it */
#define THIN_BOX     0.5  /* the same of boxes alone: no skewness, and a kurtosis of -0.0005 */
#define SHORTEST     1e-4 /* width of a box, over the exponential, whose edges are not resolved */
#define BOX_VARIANCE 12.0 /* squared width over variance */
#define NOTHING      (-40.0)       /* sigmas from which down a Gaussian is 0 in any sum */
#define ASYMPTOTIC   (-NORMAL_END) /* sigmas from which down the series of the tail is exact */

/* Integral of the Gaussian's distribution function up to -|x|: how a corner at 0 is rounded off. */
static double rounding(double x, double sigma)
{
    double z = fabs(x) / sigma;
    return z < NORMAL_END ? sigma * normal_rounding(z) : 0.0;
}

/* What is below z where it stands beside greater values: no tail is resolved. */
static double roughly_below(double z)
{
    if (fabs(z) < NORMAL_END) {
        return normal_below(z);
    }
    return z > 0.0 ? 1.0 : 0.0;
}

static double box_gauss(double x, double sigma, double box)
{
    double from_edge = lesser(x, box - x); /* of two equal values the one without cancellation */
    double inside = roughly_below(from_edge / sigma);
    return (inside - roughly_below((from_edge - box) / sigma)) / box;
}

/* A trapezoid whose four corners the Gaussian rounds off. */
static double trapezoid_gauss(double x, double sigma, double narrow, double wide)
{
    double from_edge = lesser(x, narrow + wide - x);
    double sharp = greater(0.0, lesser(from_edge, narrow));
    double corners = rounding(from_edge, sigma) - rounding(from_edge - narrow, sigma) -
                     rounding(from_edge - wide, sigma) + rounding(from_edge - narrow - wide, sigma);
    return greater(0.0, (sharp + corners) / (narrow * wide));
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
        return normal_density(x / sigma) * tail_ratio(z) / mean;
    }
    return exp(0.5 * square(ratio) - x / mean) * roughly_below(z) / mean;
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

static void fold(sum_t *sum, double *part, double middle, double variance)
{
    sum->middle += middle;
    sum->sigma = sqrt(square(sum->sigma) + variance);
    *part = 0.0;
}

void sum_fold_box(sum_t *sum, double *box)
{
    fold(sum, box, *box / 2.0, square(*box) / BOX_VARIANCE);
}

void sum_fold_thin(sum_t *sum)
{
    double mean = fabs(sum->mean);
    double thin = mean > 0.0 ? THIN : THIN_BOX; /* over the scatter */
    if (sum->narrow < greater(thin * sum->sigma, SHORTEST * mean)) {
        sum_fold_box(sum, &sum->narrow);
    }
    if (sum->wide < greater(thin * sum->sigma, SHORTEST * mean)) {
        sum_fold_box(sum, &sum->wide);
    }
    if (mean < THIN * sum->sigma) {
        fold(sum, &sum->mean, sum->mean, square(sum->mean));
    }
}

double sum_mean(const sum_t *sum)
{
    return sum->middle + (sum->narrow + sum->wide) / 2.0 + sum->mean;
}

double sum_variance(const sum_t *sum)
{
    double boxes = square(sum->narrow) + square(sum->wide);
    return square(sum->sigma) + boxes / BOX_VARIANCE + square(sum->mean);
}

static double without_exponential(const sum_t *sum, double x)
{
    if (sum->narrow > 0.0) {
        return trapezoid_gauss(x, sum->sigma, sum->narrow, sum->wide);
    }
    if (sum->wide > 0.0) {
        return box_gauss(x, sum->sigma, sum->wide);
    }
    return normal_density(x / sum->sigma) / sum->sigma;
}

/* All but the exponential is the same from either side. */
static double with_exponential(const sum_t *sum, double x)
{
    double mean = fabs(sum->mean);
    if (sum->mean < 0.0) {
        x = sum->narrow + sum->wide - x;
    }
    if (sum->narrow > 0.0) {
        return trapezoid_exponential(x, sum->sigma, sum->narrow, sum->wide, mean);
    }
    if (sum->wide > 0.0) {
        return box_exponential(x, sum->sigma, sum->wide, mean);
    }
    return exponential_gauss(x, sum->sigma, mean);
}

double sum_density(const sum_t *sum, double x)
{
    x -= sum->middle;
    bool is_plain = !(fabs(sum->mean) > 0.0);
    return is_plain ? without_exponential(sum, x) : greater(0.0, with_exponential(sum, x));
}
