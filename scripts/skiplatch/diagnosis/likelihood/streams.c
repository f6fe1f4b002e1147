#include "diagnosis/likelihood/streams.h"

#include <math.h>
#include <stdlib.h>

#include "diagnosis/density/order.h"
#include "diagnosis/density/residual.h"
#include "diagnosis/likelihood/lines.h"
#include "diagnosis/likelihood/numbers.h"
#include "diagnosis/likelihood/scan_grid.h"
#include "diagnosis/likelihood/stream_law.h"
#include "diagnosis/likelihood/tick_rest.h"

#define FAR                                                                                      \
    10.0        /* usual spreads, beyond what touches are off, within which one may lie anywhere \
                 */
#define ROOM 5u /* arrays of doubles a family */

/* Touches of streams that one datum shifts, laid out one after the other; arrays of n. */
typedef struct {
    sim_law_t   *laws;
    sim_extra_t *extras; /* [extra_count][n] */
    double      *residuals;
    double      *reach;
    double      *per_length;
    double      *logs;
    double      *work;
    uint32_t    *groups;
    uint64_t     n;
    uint32_t     extra_count;
} family_t;

/* Which family a stream belongs to; SIM_FAMILY_COUNT for none, where it is no datum that shifts it.
 */
static uint32_t family_of(const sim_touches_t *of, uint32_t stream)
{
    bool is_of_time = stream == SIM_MOTION || stream == SIM_LATTICE || stream == SIM_REPORT;
    if (of->datum_count == 0u || is_of_time) {
        return SIM_FAMILY_COUNT;
    }
    if (is_beyond_stamp(stream)) {
        return SIM_BY_COORDINATES;
    }
    return is_deviation(stream) ? SIM_WITHOUT_STAMPS : SIM_BY_STAMPS;
}

static void release(family_t *family)
{
    free(family->laws);
    free(family->extras);
    free(family->residuals);
    free(family->groups);
}

/* Make room for touches, with so many extras; false if there is none. */
static bool make_room(family_t *family, uint64_t n, uint32_t extra_count)
{
    double *values = calloc(ROOM * n + 1u, sizeof *values);
    *family = (family_t){
        .laws = calloc(n + 1u, sizeof *family->laws),
        .extras = calloc(n * extra_count + 1u, sizeof *family->extras),
        .residuals = values,
        .groups = calloc(n + 1u, sizeof *family->groups),
        .n = n,
        .extra_count = extra_count,
    };
    if (family->laws == NULL || family->extras == NULL || values == NULL ||
        family->groups == NULL) {
        release(family);
        return false;
    }
    family->reach = values + n;
    family->per_length = values + 2u * n;
    family->logs = values + 3u * n;
    family->work = values + 4u * n;
    return true;
}

static sim_residuals_t laid_out(const sim_touches_t *of, const family_t *family)
{
    return (sim_residuals_t){
        .residuals = family->residuals,
        .laws = family->laws,
        .extras = family->extras,
        .reach = family->reach,
        .n = family->n,
        .extra_count = family->extra_count,
        .resolution = of->resolution,
    };
}

/* Middle one of the scatters of `count` laws, their extras left out. */
static double usual_spread(const sim_residuals_t *all, uint64_t begin, uint64_t count, double *work)
{
    for (uint64_t k = 0; k < count; ++k) {
        residual_part_t plain = residual_part(all, begin + k, 0);
        work[k] = sqrt(sum_variance(&plain.sum));
    }
    return order_median(work, (int64_t)count);
}

/* Lay a member out, as touches of its family from number `begin` on; 0, or -1. */
static int lay_out(const sim_touches_t *of, const sim_member_t *member, family_t *family,
                   uint64_t begin)
{
    bool         is_time = member->stream == SIM_LATCH_SKIP || member->stream == SIM_LATCH_PLC;
    sim_extra_t *extras = family->extras + begin;
    if (sim_stream_laws(of, member, family->n, family->laws + begin, extras) != 0) {
        return -1;
    }
    for (uint64_t k = 0; k < member->count; ++k) {
        uint64_t i = member->rows[k];
        family->residuals[begin + k] = member->recorded->residuals[i];
        family->per_length[begin + k] = of->datum_senses[i] / (is_time ? of->speed[i] : 1.0);
        family->groups[begin + k] = of->datum_count == 0u ? 0u : of->groups[i];
    }
    sim_residuals_t all = laid_out(of, family);
    double reach = FAR * usual_spread(&all, begin, member->count, family->work) + member->far;
    for (uint64_t k = 0; k < member->count; ++k) {
        family->reach[begin + k] = reach;
    }
    bool is_early = member->stream == SIM_POSITION && of->is_polled != 0u;
    return is_early ? take_tick_rest(of, member, &all, begin, family->residuals) : 0;
}

/* Add what a member of a family, laid out from number `begin` on, says of each touch. */
static void add(const sim_touches_t *of, const sim_member_t *member, family_t *family,
                uint64_t begin, double *values)
{
    sim_line_bonus(of, member, family->work);
    for (uint64_t k = 0; k < member->count; ++k) {
        values[member->stream * of->n + member->rows[k]] +=
            family->logs[begin + k] + family->work[k];
    }
}

/* Write the densities of a family that is laid out, at its likeliest datum if it has one. */
static int weigh(const sim_touches_t *of, family_t *family, bool has_datum, double *found)
{
    sim_residuals_t all = laid_out(of, family);
    if (!has_datum) {
        sim_law_log_density(&all, family->logs);
        return 0;
    }
    for (uint64_t k = 0; k < family->n; ++k) {
        family->logs[k] = -HUGE_VAL; /* where no length is likely at all, none is written */
    }
    sim_datum_t datum = {.per_length = family->per_length,
                         .groups = family->groups,
                         .group_count = of->datum_count,
                         .u = of->datum_u_um};
    return sim_law_at_best_datum(&all, &datum, found, family->logs);
}

/* Evaluate some members: those of one family, or a single one that has none. */
static int evaluate(const sim_touches_t *of, const sim_member_t *const *members, uint32_t count,
                    double *values, double *found)
{
    uint64_t n = 0;
    uint32_t extra_count = 0;
    for (uint32_t m = 0; m < count; ++m) {
        uint32_t more = members[m]->change->extra_counts[members[m]->stream];
        n += members[m]->count;
        extra_count = more > extra_count ? more : extra_count;
    }
    family_t family;
    if (!make_room(&family, n, extra_count)) {
        return -1;
    }
    int      code = 0;
    uint64_t begin = 0;
    for (uint32_t m = 0; m < count && code == 0; begin += members[m++]->count) {
        code = lay_out(of, members[m], &family, begin);
    }
    if (code == 0) {
        code = weigh(of, &family, family_of(of, members[0]->stream) < SIM_FAMILY_COUNT, found);
    }
    begin = 0;
    for (uint32_t m = 0; m < count && code == 0; begin += members[m++]->count) {
        add(of, members[m], &family, begin, values);
    }
    release(&family);
    return code;
}

int sim_streams_log_likelihood(const sim_touches_t *of, const sim_member_t *members,
                               uint32_t member_count, double *values, double *found)
{
    const sim_member_t **together =
        (const sim_member_t **)calloc(member_count + (size_t)1, sizeof *together);
    int code = together == NULL ? -1 : 0;
    for (uint32_t f = 0; f < SIM_FAMILY_COUNT && code == 0; ++f) {
        uint32_t count = 0;
        for (uint32_t m = 0; m < member_count; ++m) {
            if (members[m].count > 0u && family_of(of, members[m].stream) == f) {
                together[count++] = &members[m];
            }
        }
        code = count == 0u
                   ? 0
                   : evaluate(of, together, count, values, found + (size_t)f * of->datum_count);
    }
    for (uint32_t m = 0; m < member_count && code == 0; ++m) {
        const sim_member_t *alone = &members[m];
        if (alone->count > 0u && family_of(of, alone->stream) == SIM_FAMILY_COUNT) {
            code = alone->stream == SIM_LATTICE
                       ? weigh_grid(of, alone, values + SIM_LATTICE * of->n)
                       : evaluate(of, &alone, 1, values, NULL);
        }
    }
    free((void *)together);
    return code;
}
