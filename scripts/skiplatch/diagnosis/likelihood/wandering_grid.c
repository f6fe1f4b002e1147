#include "diagnosis/likelihood/wandering_grid.h"

#include <math.h>

#include "angle.h"
#include "diagnosis/density/sum.h"

#define NEIGHBOURS 9 /* stamps in a row by which one tells where the grid is while it wanders */
#define NO_ACCIDENT                                                                   \
    20.0 /* of stamps about a grid: their number times the square of their mean turn; \
          * a period that is searched for holds any a little */
#define SCATTERED                                                                   \
    0.3 /* nats a stamp that speak against a scatter for which a grid has no reason \
         */
#define TINY   1e-9
#define BEYOND 20.0  /* argument from which on a Bessel function's asymptotic series will do */
#define EXACT  1e-16 /* of a sum, below which a term adds nothing */

/* A point on or in the unit circle. */
typedef struct {
    double x;
    double y;
} point_t;

/* Modified Bessel function of order 0 times exp(-x), x >= 0 (Abramowitz and Stegun 9.6.12, 9.7.1).
 */
static double scaled_bessel(double x)
{
    double term = 1.0;
    double sum = 1.0;
    bool   is_small = x < BEYOND;
    for (int k = 1; term > EXACT * sum && (is_small || k < (int)BEYOND); ++k) {
        term *= is_small ? square(x / 2.0 / k) : square(2.0 * k - 1.0) / (8.0 * x * k);
        sum += term;
    }
    return is_small ? sum * exp(-x) : sum / sqrt(2.0 * PI * x);
}

/* Number of the stamp that stands for one before the first or behind the last: its mirror image. */
static uint64_t mirrored(int64_t k, uint64_t n)
{
    int64_t last = (int64_t)n - 1;
    if (last == 0) {
        return 0u;
    }
    int64_t within = k < 0 ? -k : k;
    within %= 2 * last;
    return (uint64_t)(within <= last ? within : 2 * last - within);
}

/* Sum of the points about stamp k, without it. */
static point_t near_by(const double *xs, const double *ys, uint64_t n, uint64_t k)
{
    int64_t half = (int64_t)((n < NEIGHBOURS ? n | 1u : NEIGHBOURS) / 2u);
    point_t sum = {.x = -xs[k], .y = -ys[k]};
    for (int64_t step = -half; step <= half; ++step) {
        uint64_t other = mirrored((int64_t)k + step, n);
        sum.x += xs[other];
        sum.y += ys[other];
    }
    return sum;
}

static double cosine_between(double x, double y, point_t middle)
{
    double length = hypot(middle.x, middle.y);
    return length > 0.0 ? (x * middle.x + y * middle.y) / length : 1.0;
}

bool weigh_wandering(const double *turns, uint64_t n, double tick, bool everywhere, double *room,
                     double *values)
{
    double *xs = room;
    double *ys = room + n;
    point_t all = {0};
    double  kept = 0.0;
    for (uint64_t k = 0; k < n; ++k) {
        xs[k] = cos(2.0 * PI * turns[k]);
        ys[k] = sin(2.0 * PI * turns[k]);
        all = (point_t){.x = all.x + xs[k], .y = all.y + ys[k]};
    }
    for (uint64_t k = 0; k < n; ++k) {
        point_t others = {.x = all.x - xs[k], .y = all.y - ys[k]};
        point_t middle = everywhere ? others : near_by(xs, ys, n, k);
        values[k] = cosine_between(xs[k], ys[k], middle);
        kept += values[k] / (double)n;
    }
    if (kept <= 0.0 || (double)n * square(kept) <= NO_ACCIDENT) {
        return false;
    }
    /* Concentration by Banerjee et al., J. Mach. Learn. Res. 6 (2005), eq. 4.4. */
    double sharp = kept * (2.0 - square(kept)) / fmax(1.0 - square(kept), TINY);
    sharp = fmin(sharp, 1.0 / square(2.0 * PI * tick));
    double level = log(scaled_bessel(sharp)) + (everywhere ? SCATTERED : 0.0);
    for (uint64_t k = 0; k < n; ++k) {
        values[k] = sharp * (values[k] - 1.0) - level;
    }
    return true;
}
