#include "diagnosis/density/law.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "angle.h"

#define CONTAMINATION 1e-3 /* share of residuals that may lie anywhere */
#define THIN          0.1  /* what a box or an exponential, over the Gaussian, only adds to it */
#define THIN_BOX      0.5  /* the same of boxes alone: no skewness, and a kurtosis of -0.0005 */
#define SHORTEST      1e-4 /* width of a box, over the exponential, whose edges are not resolved */
#define BOX_VARIANCE  12.0 /* squared width over variance */
#define SQRT_2        1.4142135623730951
#define SQRT_2_PI     2.5066282746310002
#define NO_TAIL       12.0    /* sigmas beyond which what is left of a Gaussian changes no sum */
#define NOTHING       (-40.0) /* sigmas from which down a Gaussian is 0 in any sum */
#define ROUNDS        2       /* parabolas that the best length is taken from */
#define MOST_ROUNDS   30      /* of them, on the way to a top that is far away */
#define NARROWER      0.3     /* steps of a round, over those of the one before */
#define FARTHEST      2.0     /* steps from the middle of a parabola that its top is believed */
#define FAR           0.7     /* steps to the top beyond which a parabola is drawn again */
#define NEAR          4.0     /* steps within which 0 may be as likely as the best length */
#define FLAT          1e-9    /* nats by which a parabola bends at least */
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
    double thin = sum->mean > 0.0 ? THIN : THIN_BOX; /* over the scatter */
    if (sum->narrow < fmax(thin * sum->sigma, SHORTEST * sum->mean)) {
        fold_box(sum, &sum->narrow);
    }
    if (sum->wide < fmax(thin * sum->sigma, SHORTEST * sum->mean)) {
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

/* The density of residual i, moved by -moved. */
static double log_density(const sim_residuals_t *of, uint64_t i, double moved)
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

void sim_law_log_density(const sim_residuals_t *of, double *log_densities)
{
    for (uint64_t i = 0; i < of->n; ++i) {
        log_densities[i] = log_density(of, i, 0.0);
    }
}

/* The best length of each group so far, and what was tried last. */
typedef struct {
    double *best;  /* of each group */
    double *most;  /* log-likelihood there */
    double *tried; /* of each group */
    double *value; /* log-likelihood there */
    double *kept;  /* log-densities at the best, of each residual */
    double *seen;  /* at what was tried */
} search_t;

static double believed(double datum, double u)
{
    return u > 0.0 ? -0.5 * square(datum / u) : 0.0;
}

/* Evaluate what is tried, and keep what is better. */
static void evaluate(const sim_residuals_t *of, const sim_datum_t *datum, search_t *search)
{
    for (uint32_t g = 0; g < datum->group_count; ++g) {
        search->value[g] = believed(search->tried[g], datum->u);
    }
    for (uint64_t i = 0; i < of->n; ++i) {
        uint32_t g = datum->groups[i];
        search->seen[i] = log_density(of, i, search->tried[g] * datum->per_length[i]);
        search->value[g] += search->seen[i];
    }
    for (uint64_t i = 0; i < of->n; ++i) {
        uint32_t g = datum->groups[i];
        if (search->value[g] > search->most[g]) {
            search->kept[i] = search->seen[i];
        }
    }
    for (uint32_t g = 0; g < datum->group_count; ++g) {
        if (search->value[g] > search->most[g]) {
            search->most[g] = search->value[g];
            search->best[g] = search->tried[g];
        }
    }
}

/* Go to the top of a parabola through the best length and one step to either side; again where
 * that was far away, with narrower steps once the top is near. `work` has room for three values of
 * each group. */
static void climb(const sim_residuals_t *of, const sim_datum_t *datum, search_t *search,
                  double *work)
{
    uint32_t groups = datum->group_count;
    double  *middle = work;
    double  *most = work + groups;
    double  *left = work + 2 * (size_t)groups;
    double   narrower = 1.0;
    int      narrowed = 0;
    bool     is_far = true;
    for (int round = 0; round < MOST_ROUNDS && narrowed < ROUNDS && is_far; ++round) {
        for (uint32_t g = 0; g < groups; ++g) {
            middle[g] = search->best[g];
            most[g] = search->most[g];
            search->tried[g] = middle[g] - narrower * datum->steps[g];
        }
        evaluate(of, datum, search);
        for (uint32_t g = 0; g < groups; ++g) {
            left[g] = search->value[g];
            search->tried[g] = middle[g] + narrower * datum->steps[g];
        }
        evaluate(of, datum, search);
        is_far = false;
        bool is_beyond = false;
        for (uint32_t g = 0; g < groups; ++g) {
            double bend = fmax(2.0 * most[g] - left[g] - search->value[g], FLAT);
            double turn = 0.5 * (search->value[g] - left[g]) / bend;
            double steps = fmin(fmax(turn, -FARTHEST), FARTHEST);
            search->tried[g] = middle[g] + narrower * steps * datum->steps[g];
            is_far = is_far || fabs(turn) > FAR;
            is_beyond = is_beyond || fabs(turn) > FARTHEST;
        }
        evaluate(of, datum, search);
        if (!is_beyond) {
            narrower *= NARROWER;
            ++narrowed;
        }
    }
}

/* What is believed loses nothing: 0 is tried as well where it is near. */
static void try_believed(const sim_residuals_t *of, const sim_datum_t *datum, search_t *search)
{
    bool is_near = false;
    for (uint32_t g = 0; g < datum->group_count; ++g) {
        search->tried[g] = 0.0;
        is_near = is_near || fabs(search->best[g]) < NEAR * datum->steps[g];
    }
    if (is_near) {
        evaluate(of, datum, search);
    }
}

int sim_law_at_best_datum(const sim_residuals_t *of, const sim_datum_t *datum, double *found,
                          double *log_densities)
{
    uint32_t groups = datum->group_count;
    double  *work = calloc(6 * (size_t)groups + of->n + 1, sizeof *work);
    if (work == NULL) {
        return -1;
    }
    search_t search = {.best = found,
                       .most = work,
                       .tried = work + groups,
                       .value = work + 2 * (size_t)groups,
                       .kept = log_densities,
                       .seen = work + 6 * (size_t)groups};
    for (uint32_t g = 0; g < groups; ++g) {
        search.most[g] = -HUGE_VAL;
        search.tried[g] = datum->guesses[g];
    }
    evaluate(of, datum, &search);
    climb(of, datum, &search, work + 3 * (size_t)groups);
    try_believed(of, datum, &search);
    free(work);
    return 0;
}
