#include "diagnosis/density/law.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "diagnosis/density/residual.h"

#define ROUNDS      2    /* parabolas that the best length is taken from */
#define MOST_ROUNDS 30   /* of them, on the way to a top that is far away */
#define NARROWER    0.3  /* steps of a round, over those of the one before */
#define FARTHEST    2.0  /* steps from the middle of a parabola that its top is believed */
#define FAR         0.7  /* steps to the top beyond which a parabola is drawn again */
#define NEAR        4.0  /* steps within which 0 may be as likely as the best length */
#define FLAT        1e-9 /* nats by which a parabola bends at least */

void sim_law_log_density(const sim_residuals_t *of, double *log_densities)
{
    for (uint64_t i = 0; i < of->n; ++i) {
        double density = 0.0;
        for (uint32_t k = 0; k <= of->extra_count; ++k) {
            residual_part_t part = residual_part(of, i, k);
            density += residual_part_density(&part, of->residuals[i]);
        }
        log_densities[i] = residual_log_density(density, of->residuals[i], of->reach[i]);
    }
}

/* ---- the likeliest datum ---- */

/* The best length of each group so far, and what was tried last. */
typedef struct {
    const residual_part_t *parts; /* of each residual in turn, the same whatever is tried */
    double                *best;  /* of each group */
    double                *most;  /* log-likelihood there */
    double                *tried; /* of each group */
    double                *value; /* log-likelihood there */
    double                *kept;  /* log-densities at the best, of each residual */
    double                *seen;  /* at what was tried */
    bool *is_settled; /* of each group: none was better, and the next round would try the same */
} search_t;

static double believed(double datum, double u)
{
    return u > 0.0 ? -0.5 * ((datum / u) * (datum / u)) : 0.0;
}

/* Log-density of residual i at what is tried. */
static double log_density(const sim_residuals_t *of, const sim_datum_t *datum,
                          const search_t *search, uint64_t i)
{
    const uint64_t         part_count = of->extra_count + (uint64_t)1;
    const residual_part_t *parts = &search->parts[i * part_count];
    double x = of->residuals[i] - search->tried[datum->groups[i]] * datum->per_length[i];
    double density = 0.0;
    for (uint64_t k = 0; k < part_count; ++k) {
        density += residual_part_density(&parts[k], x);
    }
    return residual_log_density(density, x, of->reach[i]);
}

/* Evaluate what is tried, and keep what is better. */
static void evaluate(const sim_residuals_t *of, const sim_datum_t *datum, search_t *search)
{
    for (uint32_t g = 0; g < datum->group_count; ++g) {
        search->value[g] = search->is_settled[g] ? -HUGE_VAL : believed(search->tried[g], datum->u);
    }
    for (uint64_t i = 0; i < of->n; ++i) {
        if (!search->is_settled[datum->groups[i]]) {
            search->seen[i] = log_density(of, datum, search, i);
            search->value[datum->groups[i]] += search->seen[i];
        }
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
            if (search->is_settled[g]) {
                continue; /* near its top: a side that is far better would have become the best */
            }
            double bend = fmax(2.0 * most[g] - left[g] - search->value[g], FLAT);
            double turn = 0.5 * (search->value[g] - left[g]) / bend;
            double steps = fmin(fmax(turn, -FARTHEST), FARTHEST);
            search->tried[g] = middle[g] + narrower * steps * datum->steps[g];
            is_far = is_far || fabs(turn) > FAR;
            is_beyond = is_beyond || fabs(turn) > FARTHEST;
        }
        evaluate(of, datum, search);
        for (uint32_t g = 0; g < groups; ++g) {
            search->is_settled[g] = is_beyond && search->most[g] <= most[g];
        }
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
        search->is_settled[g] = false;
        is_near = is_near || fabs(search->best[g]) < NEAR * datum->steps[g];
    }
    if (is_near) {
        evaluate(of, datum, search);
    }
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
    uint32_t         groups = datum->group_count;
    double          *work = calloc(6 * (size_t)groups + of->n + 1, sizeof *work);
    residual_part_t *parts = parts_of(of);
    bool            *is_settled = calloc((size_t)groups + 1, sizeof *is_settled);
    bool             is_room = work != NULL && parts != NULL && is_settled != NULL;
    if (is_room) {
        search_t search = {.parts = parts,
                           .best = found,
                           .most = work,
                           .tried = work + groups,
                           .value = work + 2 * (size_t)groups,
                           .kept = log_densities,
                           .seen = work + 6 * (size_t)groups,
                           .is_settled = is_settled};
        for (uint32_t g = 0; g < groups; ++g) {
            search.most[g] = -HUGE_VAL;
            search.tried[g] = datum->guesses[g];
        }
        evaluate(of, datum, &search);
        climb(of, datum, &search, work + 3 * (size_t)groups);
        try_believed(of, datum, &search);
    }
    free(is_settled);
    free(parts);
    free(work);
    return is_room ? 0 : -1;
}
