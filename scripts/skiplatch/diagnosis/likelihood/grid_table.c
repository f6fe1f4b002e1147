#include "diagnosis/likelihood/grid_table.h"

#include <math.h>
#include <stdlib.h>

#include "diagnosis/density/order.h"
#include "diagnosis/density/residual.h"
#include "diagnosis/likelihood/numbers.h"

#define PEAK       129u /* places about 0 */
#define REST       257u /* places over the period */
#define EDGE       17u  /* places about an edge of the law */
#define TICKS      4.0  /* to each side of 0 and of an edge */
#define FARTHER    1.25 /* of a place from there is the next one, up to those over the period */
#define MOST_TURNS 4.0  /* periods after which a late scan is not followed further */
#define FEWEST     8.0  /* phases of late scans, as powers of 2 */
#define MOST       13.0
#define BLOCK      16u /* phases that one bound holds for */

/* A law with its extras, ready for its density at many places. */
typedef struct {
    residual_part_t *parts;
    uint32_t         count;
    uint32_t         turns; /* periods over which a late scan is followed */
    double           period;
} folded_law_t;

static uint64_t put_evenly(double *where, uint64_t count, double middle, double reach)
{
    for (uint64_t k = 0; k < count; ++k) {
        where[k] = middle + reach * (2.0 * (double)k / (double)(count - 1u) - 1.0);
    }
    return count;
}

/* How many places, ever farther apart, lie to each side of what is tabulated closely. */
static uint64_t farther_places(double tick, double period)
{
    double ratio = period / ((double)(REST - 1u) * TICKS * tick);
    return ratio > 1.0 ? (uint64_t)ceil(log(ratio) / log(FARTHER)) : 0u;
}

/* Laws fall by orders of magnitude within a tick, or within hundreds: places lie as close to where
 * they begin to as suits either, for the logarithm is taken as straight between two. */
static uint64_t put_about(double *where, double middle, uint64_t close, double tick, double period)
{
    uint64_t count = put_evenly(where, close, middle, TICKS * tick);
    double   away = TICKS * tick;
    for (uint64_t k = farther_places(tick, period); k > 0u; --k) {
        away *= FARTHER;
        where[count++] = middle - away;
        where[count++] = middle + away;
    }
    for (uint64_t k = 0; k < count; ++k) { /* which may pass the end */
        where[k] = folded(where[k], period);
    }
    return count;
}

static uint64_t put_edge(double *where, double edge, double tick, double period)
{
    return fabs(edge) > 0.0 ? put_about(where, edge, EDGE, tick, period) : 0u;
}

/* Put the places at which a law is tabulated, in their order: how many they are. */
static uint64_t put_places(double *where, const sim_law_t *law, const sim_extra_t *extras,
                           uint32_t extra_count, double tick, double period)
{
    uint64_t n = put_evenly(where, REST, 0.0, period / 2.0);
    n += put_about(where + n, 0.0, PEAK, tick, period);
    n += put_edge(where + n, law->offset, tick, period);
    n += put_edge(where + n, law->offset + law->box_a, tick, period);
    for (uint32_t k = 0; k < extra_count; ++k) {
        n += put_edge(where + n, extras[k].offset, tick, period);
        n += put_edge(where + n, extras[k].offset + extras[k].width, tick, period);
    }
    order_sort(where, n);
    return n;
}

static uint32_t turns_of(const sim_extra_t *extras, uint32_t extra_count, double period)
{
    double end = 0.0;
    for (uint32_t k = 0; k < extra_count; ++k) {
        end = fmax(end, extras[k].offset + extras[k].width);
    }
    return extra_count == 0u ? 1u : (uint32_t)fmin(floor(end / period), MOST_TURNS) + 2u;
}

static double log_at(const folded_law_t *law, double place)
{
    double all = 0.0;
    for (uint32_t turn = 0; turn < law->turns; ++turn) {
        double x = place + law->period * (double)turn;
        all += residual_parts_density(law->parts, law->count, x, law->period);
    }
    return log(all * law->period);
}

int make_table(grid_table_t *table, const sim_law_t *law, const sim_extra_t *extras,
               uint32_t extra_count, double tick, double resolution, double period)
{
    uint64_t     edges = (extra_count + (uint64_t)1) * 2u;
    uint64_t     farther = (edges + 1u) * 2u * farther_places(tick, period);
    uint64_t     most = PEAK + REST + edges * EDGE + farther;
    folded_law_t ready = {.parts = calloc(extra_count + (size_t)1, sizeof *ready.parts),
                          .count = extra_count + 1u,
                          .turns = turns_of(extras, extra_count, period),
                          .period = period};
    double      *room = calloc(2u * most, sizeof *room);
    *table = (grid_table_t){.where = room, .period = period};
    if (ready.parts == NULL || room == NULL) {
        free(ready.parts);
        release_table(table);
        return -1;
    }
    table->logs = room + most;
    table->bins = (uint64_t)exp2(fmin(fmax(ceil(log2(period / tick)), FEWEST), MOST));
    sim_residuals_t one = {.laws = law,
                           .extras = extras,
                           .n = 1,
                           .extra_count = extra_count,
                           .resolution = resolution};
    for (uint32_t k = 0; k < ready.count; ++k) {
        ready.parts[k] = residual_part(&one, 0, k);
    }
    table->n = put_places(table->where, law, extras, extra_count, tick, period);
    for (uint64_t k = 0; k < table->n; ++k) {
        table->logs[k] = log_at(&ready, table->where[k]);
    }
    free(ready.parts);
    return 0;
}

void release_table(grid_table_t *table)
{
    free(table->where);
    table->where = NULL;
}

double table_value(const grid_table_t *table, double place, uint64_t *at)
{
    const double *where = table->where;
    uint64_t      k = *at;
    if (place < where[k]) {
        k = 0u;
    }
    while (k + 2u < table->n && where[k + 1u] <= place) {
        ++k;
    }
    *at = k;
    double width = where[k + 1u] - where[k];
    double share = width > 0.0 ? fmin(fmax((place - where[k]) / width, 0.0), 1.0) : 0.0;
    return table->logs[k] + share * (table->logs[k + 1u] - table->logs[k]);
}

uint64_t phase_room(const grid_table_t *table)
{
    return table->bins + 3u * (table->bins / BLOCK);
}

/* Number of a place before or behind the others, once whole periods are taken away. */
static uint64_t within(const grid_table_t *table, uint64_t bin)
{
    return bin & (table->bins - 1u); /* a power of 2 */
}

static uint64_t bin_of(const grid_table_t *table, double turn)
{
    return within(table, (uint64_t)(turn * (double)table->bins));
}

/* What stamps say of phase k: one in bin b is (b - k) bins off. */
static double total_at(const grid_table_t *table, const double *logs, const double *turns,
                       uint64_t n, uint64_t k)
{
    double total = 0.0;
    for (uint64_t s = 0; s < n; ++s) {
        total += logs[within(table, bin_of(table, turns[s]) + table->bins - k)];
    }
    return total;
}

/*
 * Write the most that stamps can say of any phase in each block of them to bounds. `most` has room
 * for two blocks each: the most that a stamp says which is so many blocks off, the last one first,
 * so that stamps are summed up in their order.
 */
static void put_bounds(const grid_table_t *table, const double *logs, const double *turns,
                       uint64_t n, double *most, double *bounds)
{
    uint64_t blocks = table->bins / BLOCK;
    for (uint64_t c = 0; c < blocks; ++c) {
        double   highest = -HUGE_VAL;
        uint64_t block = table->bins - c * BLOCK;
        for (uint64_t k = block + 1u - BLOCK; k < block + BLOCK; ++k) {
            highest = fmax(highest, logs[within(table, table->bins + k)]);
        }
        most[c] = highest;
        most[blocks + c] = highest;
        bounds[c] = 0.0;
    }
    for (uint64_t s = 0; s < n; ++s) {
        const double *off = most + blocks - bin_of(table, turns[s]) / BLOCK;
        for (uint64_t c = 0; c < blocks; ++c) {
            bounds[c] += off[c];
        }
    }
}

/* Number of the largest of values. */
static uint64_t largest(const double *values, uint64_t n)
{
    uint64_t found = 0u;
    for (uint64_t k = 1; k < n; ++k) {
        found = values[k] > values[found] ? k : found;
    }
    return found;
}

double table_phase(const grid_table_t *table, const double *turns, uint64_t n, double *room)
{
    uint64_t blocks = table->bins / BLOCK;
    double  *logs = room;
    double  *bounds = room + table->bins;
    uint64_t at = 0u;
    for (uint64_t k = 0; k < table->bins; ++k) {
        double place = folded((double)k / (double)table->bins, 1.0) * table->period;
        logs[k] = table_value(table, place, &at);
    }
    put_bounds(table, logs, turns, n, bounds + blocks, bounds);
    uint64_t best = 0u;
    double   most = -HUGE_VAL;
    uint64_t c = largest(bounds, blocks);
    while (bounds[c] > most) {
        for (uint64_t k = c * BLOCK; k < (c + 1u) * BLOCK; ++k) {
            double total = total_at(table, logs, turns, n, k);
            best = total > most ? k : best;
            most = fmax(most, total);
        }
        bounds[c] = -HUGE_VAL;
        c = largest(bounds, blocks);
    }
    return (double)best / (double)table->bins;
}
