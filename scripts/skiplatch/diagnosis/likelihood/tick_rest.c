#include "diagnosis/likelihood/tick_rest.h"

#include <math.h>
#include <stdlib.h>

#include "diagnosis/density/order.h"
#include "diagnosis/density/residual.h"
#include "diagnosis/likelihood/numbers.h"

#define TINY 1e-9

/* Take the middle of each group of touches away if their datum is unknown. `work` has room for
 * all. */
static void take_middles(const sim_touches_t *of, const sim_member_t *member, double *off,
                         double *work)
{
    for (uint32_t g = 0; g < of->datum_count; ++g) {
        int64_t count = 0;
        for (uint64_t k = 0; k < member->count; ++k) {
            if (of->groups[member->rows[k]] == g) {
                work[count++] = off[k];
            }
        }
        double middle = count == 0 ? 0.0 : order_median(work, count);
        for (uint64_t k = 0; k < member->count; ++k) {
            off[k] -= of->groups[member->rows[k]] == g ? middle : 0.0;
        }
    }
}

/* Speed at which a touch moves on while its stamp waits for a tick. */
static double speed_of(const sim_touches_t *of, uint64_t i)
{
    return of->is_plc[i] != 0u ? of->speed[i] : 0.0;
}

/* The rest of a tick, as the touches say, by what each is off. */
static double told_us(const sim_touches_t *of, const sim_member_t *member, const double *off,
                      const double *variances)
{
    double pull = 0.0;
    double weight = 0.0;
    for (uint64_t k = 0; k < member->count; ++k) {
        double speed = speed_of(of, member->rows[k]);
        pull += speed / variances[k] * limited(off[k], CALM * sqrt(variances[k]));
        weight += speed / variances[k] * speed;
    }
    return limited(pull / fmax(weight, TINY), fmax(of->tick_us, member->change->coarse_us) / 2.0);
}

int take_tick_rest(const sim_touches_t *of, const sim_member_t *member,
                   const sim_residuals_t *laid_out, uint64_t begin, double *residuals)
{
    double          *room = calloc(3u * member->count + 1u, sizeof *room);
    residual_part_t *parts = calloc(laid_out->extra_count + (size_t)1, sizeof *parts);
    bool             is_room = room != NULL && parts != NULL;
    if (is_room) {
        double *off = room;
        double *variances = room + member->count;
        for (uint64_t k = 0; k < member->count; ++k) {
            moments_t law = residual_law_moments(laid_out, begin + k, parts);
            off[k] = residuals[begin + k] - law.mean;
            variances[k] = law.variance;
        }
        take_middles(of, member, off, variances + member->count);
        double rest_us = told_us(of, member, off, variances);
        for (uint64_t k = 0; k < member->count; ++k) {
            residuals[begin + k] -= speed_of(of, member->rows[k]) * rest_us;
        }
    }
    free(parts);
    free(room);
    return is_room ? 0 : -1;
}
