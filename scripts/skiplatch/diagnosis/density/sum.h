/*
 * Density, in closed form, of a Gaussian with two boxes and an exponential on top. Only residual.c
 * uses it.
 */
#ifndef DIAGNOSIS_SUM_H
#define DIAGNOSIS_SUM_H

/* A Gaussian about `middle`, two boxes from 0 and an exponential, which takes away if its mean is
 * below 0; 0 is what is not there. */
typedef struct {
    double middle;
    double sigma;
    double narrow;
    double wide;
    double mean;
} sum_t;

/* Make a box a part of the Gaussian, by mean and variance; it is 0 then. */
void sum_fold_box(sum_t *sum, double *box);

/* Make what is too thin to have a shape of its own a part of the Gaussian. */
void sum_fold_thin(sum_t *sum);

double sum_mean(const sum_t *sum);
double sum_variance(const sum_t *sum);

/* The density at x, ≥ 0, of a sum with nothing too thin in it. */
double sum_density(const sum_t *sum, double x);

static inline double square(double x)
{
    return x * x;
}

/* The lesser and the greater of two numbers, the first one beside NaN. Of these there are millions,
 * and fmin and fmax are calls. */
static inline double lesser(double a, double b)
{
    return b < a ? b : a;
}

static inline double greater(double a, double b)
{
    return b > a ? b : a;
}

#endif
