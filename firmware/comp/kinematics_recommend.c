#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "comp/kinematics.h"
#include "comp/kinematics_chain.h"
#include "comp/kinematics_problem.h"

#define GRID_DEG       30.0
#define TURN_DEG       360.0
#define TRAVEL_MAX_DEG 1.0e6
#define GOAL           4.0    /* variance of a parameter over that of a coordinate */
#define BARELY         1.0e-3 /* what is known of every unknown before the first point: 1 m */
#define FREEDOM_MIN    6      /* to tell the noise as well */

/* Positions of the grid are numbered; an axis has at most a turn of them. */
typedef struct {
    int32_t steps[KINEMATICS_AXES_MAX];
    double  first_deg[KINEMATICS_AXES_MAX];
    int32_t count;
} grid_t;

/* Of a travel of more than a turn the turn about 0 counts, as far as it is within. */
static grid_t grid_of(const kinematics_machine_t *machine, const kinematics_travel_t *travel)
{
    grid_t grid = {.count = 1};
    for (int32_t j = 0; j < machine->axes_count; j++) {
        double about_0_deg = fmin(-0.5 * TURN_DEG, travel->high_deg[j] - TURN_DEG);
        double low_deg = fmax(travel->low_deg[j], about_0_deg);
        double high_deg = fmin(travel->high_deg[j], low_deg + TURN_DEG - 1.0);
        double first = ceil(low_deg / GRID_DEG);
        double last = floor(high_deg / GRID_DEG);
        grid.first_deg[j] = last >= first ? first * GRID_DEG : low_deg;
        grid.steps[j] = last >= first ? (int32_t)(last - first) + 1 : 1;
        grid.count *= grid.steps[j];
    }
    return grid;
}

static bool travel_is_good(const kinematics_machine_t *machine, const kinematics_travel_t *travel)
{
    bool good = true;
    for (int32_t j = 0; j < machine->axes_count; j++) {
        good = good && travel->low_deg[j] >= -TRAVEL_MAX_DEG &&
               travel->low_deg[j] <= travel->high_deg[j] && travel->high_deg[j] <= TRAVEL_MAX_DEG;
    }
    return good;
}

static void grid_point(const kinematics_machine_t *machine, const grid_t *grid, int32_t number,
                       const double *unknowns, kinematics_point_t *point)
{
    memset(point, 0, sizeof *point);
    for (int32_t j = 0; j < machine->axes_count; j++) {
        int32_t steps = grid->steps[j] > 0 ? grid->steps[j] : 1;
        point->angle_deg[j] = grid->first_deg[j] + GRID_DEG * (double)(number % steps);
        number /= steps;
    }
    kinematics_chain_position(machine, unknowns, point->angle_deg, point->position_mm);
}

/* What is looked for: the unknowns that old points and the whole grid together determine. */
typedef struct {
    const kinematics_machine_t *machine;
    const double               *unknowns;
    kinematics_rank_t           rank;
    kinematics_triangle_t       known;
} design_t;

static void picked_rows(const design_t *design, const kinematics_point_t *point,
                        double picked[3][KINEMATICS_UNKNOWNS_MAX + 1])
{
    double rows[3][KINEMATICS_UNKNOWNS_MAX + 1];
    kinematics_problem_rows(design->machine, design->unknowns, point, rows);
    for (int32_t k = 0; k < 3; k++) {
        for (int32_t c = 0; c < design->rank.rank; c++) {
            picked[k][c] = rows[k][design->rank.pivots[c]];
        }
        picked[k][design->rank.rank] = 0.0;
    }
}

static void learn(design_t *design, const kinematics_point_t *point)
{
    double picked[3][KINEMATICS_UNKNOWNS_MAX + 1];
    picked_rows(design, point, picked);
    for (int32_t k = 0; k < 3; k++) {
        kinematics_triangle_add(&design->known, picked[k]);
    }
}

/* By how much the point multiplies the determinant of the information: det(I + Y·Yᵀ). */
static double worth(const design_t *design, const kinematics_point_t *point)
{
    double picked[3][KINEMATICS_UNKNOWNS_MAX + 1];
    double y[3][KINEMATICS_UNKNOWNS_MAX];
    double m[3][3];
    picked_rows(design, point, picked);
    for (int32_t k = 0; k < 3; k++) {
        kinematics_triangle_whiten(&design->known, picked[k], y[k]);
        for (int32_t i = 0; i <= k; i++) {
            m[k][i] = i == k ? 1.0 : 0.0;
            for (int32_t c = 0; c < design->rank.rank; c++) {
                m[k][i] += y[k][c] * y[i][c];
            }
            m[i][k] = m[k][i];
        }
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static void best_of(const design_t *design, const grid_t *grid, kinematics_point_t *best)
{
    double most = 0.0;
    for (int32_t i = 0; i < grid->count; i++) {
        kinematics_point_t point;
        grid_point(design->machine, grid, i, design->unknowns, &point);
        double now = worth(design, &point);
        if (now > most) {
            most = now;
            *best = point;
        }
    }
}

static bool is_known(const design_t *design, int32_t points)
{
    double variances[KINEMATICS_UNKNOWNS_MAX];
    bool   known = 3 * points >= design->rank.rank + FREEDOM_MIN;
    kinematics_triangle_variances(&design->known, variances);
    for (int32_t c = 0; c < design->rank.rank; c++) {
        known = known && (design->rank.pivots[c] < KINEMATICS_NUISANCES || variances[c] <= GOAL);
    }
    return known;
}

/* Find the goal, and begin with what the old points tell. */
static void begin(design_t *design, const grid_t *grid, const kinematics_point_t *points, int32_t n)
{
    kinematics_triangle_t *all = &design->known;
    kinematics_triangle_init(all, kinematics_problem_columns(design->machine));
    kinematics_problem_add_all(design->machine, design->unknowns, points, n, all);
    for (int32_t i = 0; i < grid->count; i++) {
        kinematics_point_t point;
        grid_point(design->machine, grid, i, design->unknowns, &point);
        kinematics_problem_add_all(design->machine, design->unknowns, &point, 1, all);
    }
    kinematics_problem_rank_of(design->machine, all, n + grid->count, &design->rank);
    kinematics_triangle_init(&design->known, design->rank.rank);
    for (int32_t c = 0; c < design->rank.rank; c++) {
        double row[KINEMATICS_UNKNOWNS_MAX + 1] = {0.0};
        row[c] = BARELY;
        kinematics_triangle_add(&design->known, row);
    }
    for (int32_t i = 0; i < n; i++) {
        learn(design, &points[i]);
    }
}

static void tell_after(const design_t *design, const kinematics_point_t *points, int32_t n,
                       const kinematics_point_t *more, int32_t found, kinematics_result_t *after)
{
    kinematics_triangle_t all;
    kinematics_rank_t     rank;
    kinematics_triangle_init(&all, kinematics_problem_columns(design->machine));
    kinematics_problem_add_all(design->machine, design->unknowns, points, n, &all);
    kinematics_problem_add_all(design->machine, design->unknowns, more, found, &all);
    kinematics_problem_rank_of(design->machine, &all, n + found, &rank);
    kinematics_problem_describe(design->machine, &rank, n + found, after);
    memcpy(after->sphere_mm, design->unknowns, sizeof after->sphere_mm);
    memcpy(after->tip_mm, design->unknowns + 3, sizeof after->tip_mm);
}

int32_t kinematics_recommend(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n, const kinematics_travel_t *travel, int32_t max,
                             kinematics_point_t *more, kinematics_result_t *after)
{
    double   unknowns[KINEMATICS_UNKNOWNS_MAX] = {0.0};
    design_t design = {.machine = machine, .unknowns = unknowns};
    int      code = kinematics_problem_check(machine, points, n);
    if (code == KINEMATICS_OK && !travel_is_good(machine, travel)) {
        code = KINEMATICS_ERR_MACHINE;
    }
    if (code == KINEMATICS_OK) {
        code = kinematics_problem_start(machine, points, n, unknowns, &design.known);
    }
    if (code != KINEMATICS_OK) {
        return code;
    }
    grid_t  grid = grid_of(machine, travel);
    int32_t found = 0;
    begin(&design, &grid, points, n);
    while (found < max && !is_known(&design, n + found)) {
        best_of(&design, &grid, &more[found]);
        learn(&design, &more[found++]);
    }
    tell_after(&design, points, n, more, found, after);
    return found;
}
