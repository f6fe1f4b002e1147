#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "diagnosis/density/guess.h"
#include "diagnosis/density/law.h"
#include "diagnosis/density/residual.h"

#define FARTHEST    2.0 /* steps from the middle of a parabola that its top is believed */
#define FAR         0.7 /* steps to the top beyond which a parabola is drawn again */
#define NARROWER    0.3 /* steps to either side, over those before, to see a top better */
#define PLACES      8   /* lengths that residuals ask for, where the guess is near no top */
#define MOST_ROUNDS 8   /* parabolas from the best of those on */
#define WIDER       3.0 /* steps to either side, over those before, while the top is out of sight */
#define NEAR        4.0 /* steps within which 0 may be as likely as the best length */
#define FLAT        1e-9   /* nats by which a parabola bends at least */
#define HUGE_PRODUCT 1e150 /* of densities; one more is not out of range yet */

/* The residuals of one group, and the best length so far. */
typedef struct {
    const sim_residuals_t *of;
    const sim_datum_t     *datum;
    const residual_part_t *parts; /* of each residual in turn, the same whatever is tried */
    const uint64_t        *members;
    uint64_t               count;
    double                *kept; /* densities at the best, of each residual */
    double                *seen; /* at what was tried last */
    double                 best;
    double                 most; /* log-likelihood there */
} group_t;

static double believed(double length, double u)
{
    return u > 0.0 ? -0.5 * square(length / u) : 0.0;
}

/* Density of residual i at a length. */
static double density_at(const group_t *group, double length, uint64_t i)
{
    const sim_residuals_t *of = group->of;
    const uint64_t         part_count = of->extra_count + (uint64_t)1;
    const residual_part_t *parts = &group->parts[i * part_count];
    double                 x = of->residuals[i] - length * group->datum->per_length[i];
    return residual_parts_density(parts, part_count, x, of->reach[i]);
}

/* Give the log-likelihood at a length, and keep it if it is the best. */
static double evaluate(group_t *group, double length)
{
    double value = believed(length, group->datum->u);
    double product = 1.0; /* one logarithm does for many */
    for (uint64_t k = 0; k < group->count; ++k) {
        uint64_t i = group->members[k];
        group->seen[i] = density_at(group, length, i);
        product *= group->seen[i];
        if (product < 1.0 / HUGE_PRODUCT || product > HUGE_PRODUCT) {
            value += log(product);
            product = 1.0;
        }
    }
    value += log(product);
    if (value > group->most) {
        group->best = length;
        group->most = value;
        for (uint64_t k = 0; k < group->count; ++k) {
            group->kept[group->members[k]] = group->seen[group->members[k]];
        }
    }
    return value;
}

/* Try the top of a parabola through the best length and a step to either side; give how many steps
 * away it is. */
static double try_top(group_t *group, double step)
{
    double middle = group->best;
    double most = group->most;
    double left = evaluate(group, middle - step);
    double right = evaluate(group, middle + step);
    double bend = fmax(2.0 * most - left - right, FLAT);
    double turn = 0.5 * (right - left) / bend;
    evaluate(group, middle + fmin(fmax(turn, -FARTHEST), FARTHEST) * step);
    return fabs(turn);
}

/* Go to the top of parabolas: with ever wider steps as long as that leads on, then narrower ones
 * down to `step`, and one more where that was rough. */
static void climb(group_t *group, double step)
{
    double width = 1.0;
    bool   is_rough = true;
    for (int round = 0; round < MOST_ROUNDS && is_rough; ++round) {
        double before = group->most;
        double turn = try_top(group, width * step);
        if (turn > FARTHEST && group->most > before) {
            width *= WIDER;
        } else {
            is_rough = width > 1.0 || (turn > FAR && turn <= FARTHEST && width > NARROWER);
            width *= NARROWER;
        }
    }
}

/* Find the likeliest length. `asked` holds those that the residuals ask for, whose order is lost.
 *
 * Where many residuals are off by far more than their laws allow, the likelihood has a top about
 * each few of them: that near the middle may be any. */
static void find_best(group_t *group, guess_t guess, double *asked)
{
    bool is_free = group->datum->u <= 0.0;
    evaluate(group, guess.length);
    if (!is_free) {
        evaluate(group, 0.0); /* what is believed may have a top of its own */
    }
    double turn = guess.is_spread ? HUGE_VAL : try_top(group, guess.step);
    if (turn > FAR && turn <= FARTHEST) {
        turn = try_top(group, NARROWER * guess.step);
    }
    if (turn > FARTHEST && group->count > 0u) {
        for (int place = 0; place < PLACES; ++place) {
            evaluate(group, guess_quantile(asked, group->count, (place + 0.5) / PLACES));
        }
        climb(group, guess.step);
    }
    if (is_free && fabs(group->best) < NEAR * guess.step) {
        evaluate(group, 0.0); /* what is believed loses nothing */
    }
}

/* Write the logarithms of what is kept; where no length is likely at all, nothing is. */
static void take_logarithms(const group_t *group)
{
    for (uint64_t k = 0; k < group->count && group->most > -HUGE_VAL; ++k) {
        group->kept[group->members[k]] = log(group->kept[group->members[k]]);
    }
}

/* Sort residuals by their groups: write the members of each in turn, and where each begins. */
static void sort(const sim_residuals_t *of, const sim_datum_t *datum, uint64_t *members,
                 uint64_t *begins)
{
    for (uint64_t i = 0; i < of->n; ++i) {
        ++begins[datum->groups[i] + 1u];
    }
    for (uint32_t g = 0; g < datum->group_count; ++g) {
        begins[g + 1u] += begins[g];
    }
    for (uint64_t i = of->n; i-- > 0u;) {
        members[--begins[datum->groups[i] + 1u]] = i;
    }
    for (uint32_t g = 0; g < datum->group_count; ++g) {
        begins[g] = begins[g + 1u];
    }
    begins[datum->group_count] = of->n;
}

static residual_part_t *parts_of(const sim_residuals_t *of)
{
    const uint64_t   part_count = of->extra_count + (uint64_t)1;
    residual_part_t *parts = calloc(of->n * part_count + 1, sizeof *parts);
    for (uint64_t i = 0; parts != NULL && i < of->n; ++i) {
        for (uint32_t k = 0; k < part_count; ++k) {
            parts[i * part_count + k] = residual_part(of, i, k);
        }
    }
    return parts;
}

int sim_law_at_best_datum(const sim_residuals_t *of, const sim_datum_t *datum, double *found,
                          double *log_densities)
{
    const uint32_t   group_count = datum->group_count;
    double          *work = calloc((GUESS_ROOM + 1u) * of->n + 1u, sizeof *work);
    residual_part_t *parts = parts_of(of);
    uint64_t        *members = calloc(of->n + group_count + (uint64_t)1, sizeof *members);
    bool             is_room = work != NULL && parts != NULL && members != NULL;
    if (is_room) {
        uint64_t *begins = members + of->n;
        sort(of, datum, members, begins);
        for (uint32_t g = 0; g < group_count; ++g) {
            group_t group = {.of = of,
                             .datum = datum,
                             .parts = parts,
                             .members = members + begins[g],
                             .count = begins[g + 1u] - begins[g],
                             .kept = log_densities,
                             .seen = work + GUESS_ROOM * of->n,
                             .most = -HUGE_VAL};
            guess_t guess = guess_length(of, parts, datum, group.members, group.count, work);
            find_best(&group, guess, work);
            found[g] = group.best;
            take_logarithms(&group);
        }
    }
    free(members);
    free(parts);
    free(work);
    return is_room ? 0 : -1;
}
