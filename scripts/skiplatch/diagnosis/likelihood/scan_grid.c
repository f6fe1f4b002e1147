#include "diagnosis/likelihood/scan_grid.h"

#include <math.h>
#include <stdlib.h>

#include "diagnosis/density/order.h"
#include "diagnosis/density/residual.h"
#include "diagnosis/likelihood/grid_table.h"
#include "diagnosis/likelihood/numbers.h"
#include "diagnosis/likelihood/touch_law.h"
#include "diagnosis/likelihood/wandering_grid.h"

#define PHASES      15u  /* that are tried first of stamps without late scans */
#define NEAR        2    /* steps about a phase, to each side, and as many phases between */
#define FINER       4.0  /* by how much each step is finer than the one before */
#define FINEST_STEP 0.08 /* of a tick */
#define ANYWHERE    0.25 /* standard deviation, over a period, from which on stamps lie anywhere */
#define TINY        1e-9

/* Stamps as shares of the period, and the table of their law; arrays of n. */
typedef struct {
    double      *turns;
    double      *sorted; /* the same in their order */
    double      *found;  /* what each says */
    double      *tried;  /* the same by another reading */
    uint64_t     n;
    grid_table_t table;
    double       tick;   /* as a share of the period */
    double       coarse; /* what stamps are rounded to, as a share of it */
} grid_t;

/* A phase, as a share of the period, and what all stamps say of it. */
typedef struct {
    double phase;
    double total;
} phase_t;

sim_law_t grid_law(const sim_touches_t *of, const sim_member_t *member)
{
    const sim_change_t *change = member->change;
    sim_law_t           law = member->recorded->chain[member->rows[0]];
    /* That stamps lie on coarse ticks is told once, beside the latch: here, where within one. */
    double box = fmax(0.0, change->coarse_us - of->tick_us);
    law.box_a += box;
    law.offset -= box / 2.0;
    return law;
}

/* By how much slack scatters stamps that a clock shifts. */
static double slack_us(const sim_member_t *member)
{
    double squares = 0.0;
    for (uint64_t k = 0; k < member->count; ++k) {
        squares += square(number_at(member->change->stamp_us, member->rows[k]));
    }
    return member->change->slack * sqrt(squares / (double)member->count);
}

static void take_turns(const sim_touches_t *of, const sim_member_t *member, grid_t *grid)
{
    for (uint64_t k = 0; k < member->count; ++k) {
        uint64_t i = member->rows[k];
        double   stamp = of->latch_us[i] - number_at(member->change->stamp_us, i);
        double   turn = stamp / member->change->scan_us;
        grid->turns[k] = turn - floor(turn);
        grid->sorted[k] = grid->turns[k];
    }
    order_sort(grid->sorted, grid->n);
}

/* Write what each of some stamps says of a phase: soonest if they are sorted. */
static double weigh_phase(const grid_t *grid, const double *turns, double phase, double *values)
{
    double   total = 0.0;
    uint64_t at = 0u;
    for (uint64_t k = 0; k < grid->n; ++k) {
        double off = folded(turns[k] - phase, 1.0) * grid->table.period;
        values[k] = table_value(&grid->table, off, &at);
        total += values[k];
    }
    return total;
}

static void try_phase(const grid_t *grid, double phase, phase_t *best)
{
    double total = weigh_phase(grid, grid->sorted, phase, grid->tried);
    if (total > best->total) {
        *best = (phase_t){.phase = phase, .total = total};
    }
}

/* Keep one of stamps that have the same turn: how many there are. */
static uint64_t distinct(const grid_t *grid, double *turns)
{
    uint64_t count = 1u;
    turns[0] = grid->sorted[0];
    for (uint64_t k = 1; k < grid->n; ++k) {
        if (grid->sorted[k] > turns[count - 1u]) {
            turns[count++] = grid->sorted[k];
        }
    }
    return count;
}

/* Try where stamps are, or evenly many of these places. */
static phase_t among_stamps(const grid_t *grid, double *room)
{
    phase_t  best = {.total = -HUGE_VAL};
    uint64_t count = distinct(grid, room);
    for (uint64_t p = 0; p < PHASES && p < count; ++p) {
        double place =
            count <= PHASES ? (double)p : (double)p * (double)(count - 1u) / (double)(PHASES - 1u);
        uint64_t below = (uint64_t)place;
        uint64_t above = below + 1u < count ? below + 1u : below;
        double   phase = room[below] + (place - (double)below) * (room[above] - room[below]);
        try_phase(grid, phase, &best);
    }
    return best;
}

/* Fit the phase: from where stamps are, or from the best of many phases of late scans. */
static phase_t fit_phase(const grid_t *grid, double *room, bool has_late)
{
    phase_t best = {.total = -HUGE_VAL};
    double  step = grid->coarse;
    if (has_late) {
        try_phase(grid, table_phase(&grid->table, grid->turns, grid->n, room), &best);
        step = fmax(step, 1.0 / (double)grid->table.bins);
    } else {
        best = among_stamps(grid, room);
    }
    while (step > FINEST_STEP * grid->tick) {
        double about = best.phase;
        for (int near = -NEAR; near <= NEAR; ++near) {
            if (near != 0) {
                try_phase(grid, about + step * (double)near / NEAR, &best);
            }
        }
        step /= FINER;
    }
    return best;
}

static double sum_of(const double *values, uint64_t n)
{
    double sum = 0.0;
    for (uint64_t k = 0; k < n; ++k) {
        sum += values[k];
    }
    return sum;
}

/* Let another reading take the place of what is found, if it is likelier. */
static void take_likelier(grid_t *grid)
{
    if (sum_of(grid->tried, grid->n) > sum_of(grid->found, grid->n)) {
        double *likelier = grid->tried;
        grid->tried = grid->found;
        grid->found = likelier;
    }
}

/* Scans that begin with the motion need not keep a grid: all of them, or those bound to it. */
static void take_unlocked(grid_t *grid, double unlocked)
{
    double share = fmin(fmax(unlocked, TINY), 1.0 - TINY);
    for (uint64_t k = 0; k < grid->n; ++k) {
        grid->tried[k] = log(share * exp(grid->found[k]) + 1.0 - share);
    }
    take_likelier(grid);
    for (uint64_t k = 0; k < grid->n; ++k) {
        grid->tried[k] = 0.0;
    }
    take_likelier(grid);
}

/* Find the grid's phase, and whether it wanders or stamps are bound to something else. */
static void settle(const sim_touches_t *of, const sim_member_t *member, grid_t *grid, double *room)
{
    const sim_change_t *change = member->change;
    bool                has_late = change->extra_counts[SIM_LATTICE] > 0u;
    bool                is_changed = fabs(change->scan_us - of->scan_us) > 0.0;
    double              phase = fit_phase(grid, room, has_late).phase;
    weigh_phase(grid, grid->turns, phase, grid->found);
    for (int everywhere = 0; everywhere < 2 && is_changed && !has_late; ++everywhere) {
        if (weigh_wandering(grid->turns, grid->n, grid->coarse, everywhere != 0, room,
                            grid->tried)) {
            take_likelier(grid);
        }
    }
    if (change->is_bound != 0u) {
        take_unlocked(grid, change->unlocked);
    }
}

/* Tabulate the law of a member, with the extras of its first touch, which are those of all. */
static int tabulate(const sim_touches_t *of, const sim_member_t *member, double loose_us,
                    grid_table_t *table)
{
    uint32_t     count = member->change->extra_counts[SIM_LATTICE];
    sim_extra_t *extras = calloc(count + (size_t)1, sizeof *extras);
    if (extras == NULL) {
        return -1;
    }
    sim_law_t law = grid_law(of, member);
    law.sigma = hypot(hypot(law.sigma, member->widening), loose_us);
    for (uint32_t k = 0; k < count; ++k) {
        extras[k] = touch_extra(of, SIM_LATTICE, member->change, k, member->rows[0]);
    }
    int code = make_table(table, &law, extras, count, of->tick_us, of->resolution,
                          member->change->scan_us);
    free(extras);
    return code;
}

int weigh_grid(const sim_touches_t *of, const sim_member_t *member, double *values)
{
    const uint64_t n = member->count;
    double         scan_us = member->change->scan_us;
    grid_t         grid = {.n = n,
                           .tick = of->tick_us / scan_us,
                           .coarse = fmax(of->tick_us, member->change->coarse_us) / scan_us};
    double         loose_us = slack_us(member);
    if (loose_us > ANYWHERE * scan_us) {
        return 0; /* a clock this far from known tells no grid */
    }
    if (tabulate(of, member, loose_us, &grid.table) != 0) {
        return -1;
    }
    double *room = calloc(6u * n + phase_room(&grid.table), sizeof *room);
    bool    is_room = room != NULL;
    if (is_room) {
        grid.turns = room;
        grid.sorted = room + n;
        grid.found = room + 2u * n;
        grid.tried = room + 3u * n;
        take_turns(of, member, &grid);
        settle(of, member, &grid, room + 4u * n);
        for (uint64_t k = 0; k < n; ++k) {
            values[member->rows[k]] += grid.found[k];
        }
    }
    free(room);
    release_table(&grid.table);
    return is_room ? 0 : -1;
}
