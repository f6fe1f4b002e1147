#include "comp/kinematics_problem.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "comp/kinematics_chain.h"

#define UNIT_TOLERANCE 1.0e-4
#define OWN_MIN        0.5 /* cosine of 60° */
#define STEPS_MAX      50
#define SETTLED_MM     1.0e-8
#define FAR_MM         1000.0
#define FAR_RAD        0.5235987755982988
#define TIP_Z          5 /* place among the unknowns */

static bool is_finite(double value)
{
    return fabs(value) <= DBL_MAX;
}

static bool all_finite(const double *values, int32_t n)
{
    bool good = true;
    for (int32_t i = 0; i < n; i++) {
        good = good && is_finite(values[i]);
    }
    return good;
}

static bool axis_is_good(const kinematics_axis_t *axis)
{
    const double *d = axis->direction;
    if (axis->letter < 'A' || axis->letter > 'C' || !all_finite(d, 3) ||
        !all_finite(axis->point_mm, 3)) {
        return false;
    }
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    return fabs(length - 1.0) <= UNIT_TOLERANCE && fabs(d[axis->letter - 'A']) >= OWN_MIN;
}

static bool machine_is_good(const kinematics_machine_t *machine)
{
    bool seen[3] = {false, false, false};
    if (machine->axes_count < 1 || machine->axes_count > KINEMATICS_AXES_MAX ||
        !is_finite(machine->axial_scatter) || machine->axial_scatter < 0.0 ||
        (machine->tool_is_known && !all_finite(machine->tool_mm, 3))) {
        return false;
    }
    for (int32_t j = 0; j < machine->axes_count; j++) {
        const kinematics_axis_t *axis = &machine->axes[j];
        if (!axis_is_good(axis) || seen[axis->letter - 'A']) {
            return false;
        }
        seen[axis->letter - 'A'] = true;
    }
    return true;
}

int kinematics_problem_check(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n)
{
    if (!machine_is_good(machine)) {
        return KINEMATICS_ERR_MACHINE;
    }
    for (int32_t i = 0; i < n; i++) {
        if (!all_finite(points[i].angle_deg, machine->axes_count) ||
            !all_finite(points[i].position_mm, 3)) {
            return KINEMATICS_ERR_POINT;
        }
    }
    return n >= 1 ? KINEMATICS_OK : KINEMATICS_ERR_TOO_FEW;
}

int32_t kinematics_problem_columns(const kinematics_machine_t *machine)
{
    return KINEMATICS_NUISANCES + KINEMATICS_OF_AXIS * machine->axes_count;
}

bool kinematics_problem_tip_is_unknown(const kinematics_machine_t *machine)
{
    bool any_head = false;
    for (int32_t j = 0; j < machine->axes_count; j++) {
        any_head = any_head || machine->axes[j].is_head;
    }
    return any_head && !machine->tool_is_known;
}

double kinematics_problem_scale(int32_t column)
{
    int32_t which = (column - KINEMATICS_NUISANCES) % KINEMATICS_OF_AXIS;
    return column >= KINEMATICS_NUISANCES && which >= KINEMATICS_CHAIN_TILT ? KINEMATICS_LEVER_MM
                                                                            : 1.0;
}

/* Divide what lies along the tool by how much more it scatters. A tip that moves goes with the
 * tool: its slopes are those of 1 minus the head's turn. */
static void weigh(const kinematics_machine_t *machine, double slopes[3][KINEMATICS_UNKNOWNS_MAX],
                  double rows[3][KINEMATICS_UNKNOWNS_MAX + 1])
{
    const double tool[3] = {-slopes[0][TIP_Z], -slopes[1][TIP_Z], 1.0 - slopes[2][TIP_Z]};
    double       less = machine->axial_scatter > 0.0 ? 1.0 / machine->axial_scatter - 1.0 : 0.0;
    for (int32_t i = 0; i <= kinematics_problem_columns(machine); i++) {
        double along = tool[0] * rows[0][i] + tool[1] * rows[1][i] + tool[2] * rows[2][i];
        for (int32_t k = 0; k < 3; k++) {
            rows[k][i] += less * along * tool[k];
        }
    }
}

void kinematics_problem_rows(const kinematics_machine_t *machine, const double *unknowns,
                             const kinematics_point_t *point,
                             double                    rows[3][KINEMATICS_UNKNOWNS_MAX + 1])
{
    double  expected_mm[3];
    double  slopes[3][KINEMATICS_UNKNOWNS_MAX];
    int32_t columns = kinematics_problem_columns(machine);
    bool    tip_is_unknown = kinematics_problem_tip_is_unknown(machine);
    kinematics_chain_slopes(machine, unknowns, point->angle_deg, expected_mm, slopes);
    for (int32_t k = 0; k < 3; k++) {
        for (int32_t i = 0; i < columns; i++) {
            bool is_tip = i >= 3 && i < KINEMATICS_NUISANCES;
            rows[k][i] =
                is_tip && !tip_is_unknown ? 0.0 : slopes[k][i] / kinematics_problem_scale(i);
        }
        rows[k][columns] = point->position_mm[k] - expected_mm[k];
    }
    weigh(machine, slopes, rows);
}

bool kinematics_problem_is_free(const kinematics_machine_t *machine, int32_t parameter)
{
    const kinematics_axis_t *axis = &machine->axes[parameter / KINEMATICS_OF_AXIS];
    int32_t                  which = parameter % KINEMATICS_OF_AXIS;
    return which == KINEMATICS_CHAIN_ZERO ? axis->zero_is_free != 0 : axis->is_held[which] == 0;
}

void kinematics_problem_add_all(const kinematics_machine_t *machine, const double *unknowns,
                                const kinematics_point_t *points, int32_t n,
                                kinematics_triangle_t *triangle)
{
    double rows[3][KINEMATICS_UNKNOWNS_MAX + 1];
    for (int32_t i = 0; i < n; i++) {
        kinematics_problem_rows(machine, unknowns, &points[i], rows);
        for (int32_t k = 0; k < 3; k++) {
            kinematics_triangle_add(triangle, rows[k]);
        }
    }
}

/* Where an offset and a tilt are known only in combination the offset takes it. */
static int32_t class_of(const kinematics_machine_t *machine, int32_t parameter)
{
    if (!kinematics_problem_is_free(machine, parameter)) {
        return KINEMATICS_RANK_NEVER;
    }
    bool is_offset = parameter % KINEMATICS_OF_AXIS < KINEMATICS_CHAIN_TILT;
    return is_offset ? KINEMATICS_RANK_SECOND : KINEMATICS_RANK_THIRD;
}

void kinematics_problem_rank_of(const kinematics_machine_t  *machine,
                                const kinematics_triangle_t *triangle, int32_t n,
                                kinematics_rank_t *rank)
{
    int32_t classes[KINEMATICS_UNKNOWNS_MAX] = {KINEMATICS_RANK_FIRST};
    for (int32_t i = KINEMATICS_NUISANCES; i < kinematics_problem_columns(machine); i++) {
        classes[i] = class_of(machine, i - KINEMATICS_NUISANCES);
    }
    kinematics_rank_find(triangle, classes, KINEMATICS_TOLERANCE * sqrt(3.0 * (double)n), rank);
}

static void triangle_of(const kinematics_machine_t *machine, const double *unknowns,
                        const kinematics_point_t *points, int32_t n,
                        kinematics_triangle_t *triangle)
{
    kinematics_triangle_init(triangle, kinematics_problem_columns(machine));
    kinematics_problem_add_all(machine, unknowns, points, n, triangle);
}

void kinematics_problem_rank(const kinematics_machine_t *machine, const double *unknowns,
                             const kinematics_point_t *points, int32_t n, kinematics_rank_t *rank)
{
    kinematics_triangle_t triangle;
    triangle_of(machine, unknowns, points, n, &triangle);
    kinematics_problem_rank_of(machine, &triangle, n, rank);
}

void kinematics_problem_shares(const kinematics_machine_t *machine, const double *unknowns,
                               const kinematics_point_t *points, int32_t n, kinematics_rank_t *rank)
{
    kinematics_triangle_t triangle;
    int32_t               classes[KINEMATICS_UNKNOWNS_MAX] = {0};
    triangle_of(machine, unknowns, points, n, &triangle);
    for (int32_t i = 0; i < kinematics_problem_columns(machine); i++) {
        classes[i] = rank->depends[i] ? KINEMATICS_RANK_NEVER : KINEMATICS_RANK_FIRST;
    }
    kinematics_rank_find(&triangle, classes, 0.0, rank);
}

/* One step: the triangle of the picked columns, its solution added to the unknowns. */
static double step(const kinematics_machine_t *machine, const kinematics_point_t *points, int32_t n,
                   const kinematics_rank_t *rank, double *unknowns, kinematics_triangle_t *triangle)
{
    double rows[3][KINEMATICS_UNKNOWNS_MAX + 1];
    double picked[KINEMATICS_UNKNOWNS_MAX + 1];
    double change[KINEMATICS_UNKNOWNS_MAX];
    double largest = 0.0;
    kinematics_triangle_init(triangle, rank->rank);
    for (int32_t i = 0; i < n; i++) {
        kinematics_problem_rows(machine, unknowns, &points[i], rows);
        for (int32_t k = 0; k < 3; k++) {
            for (int32_t c = 0; c < rank->rank; c++) {
                picked[c] = rows[k][rank->pivots[c]];
            }
            picked[rank->rank] = rows[k][kinematics_problem_columns(machine)];
            kinematics_triangle_add(triangle, picked);
        }
    }
    kinematics_triangle_solve(triangle, change);
    for (int32_t c = 0; c < rank->rank; c++) {
        unknowns[rank->pivots[c]] += change[c] / kinematics_problem_scale(rank->pivots[c]);
        largest = fmax(largest, fabs(change[c]));
    }
    return largest;
}

static bool is_near(const kinematics_machine_t *machine, const double *unknowns)
{
    bool near = true;
    for (int32_t i = KINEMATICS_NUISANCES; i < kinematics_problem_columns(machine); i++) {
        double limit = kinematics_problem_scale(i) > 1.0 ? FAR_RAD : FAR_MM;
        near = near && fabs(unknowns[i]) <= limit;
    }
    return near;
}

int kinematics_problem_solve(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n, const kinematics_rank_t *rank, double *unknowns,
                             kinematics_triangle_t *triangle)
{
    for (int32_t i = 0; i < STEPS_MAX && is_near(machine, unknowns); i++) {
        if (step(machine, points, n, rank, unknowns, triangle) < SETTLED_MM) {
            return is_near(machine, unknowns) ? KINEMATICS_OK : KINEMATICS_ERR_NO_FIT;
        }
    }
    return KINEMATICS_ERR_NO_FIT;
}

/* Only the columns of sphere and tip may be picked; they do not depend on where these are. */
static void rank_of_places(const kinematics_machine_t  *machine,
                           const kinematics_triangle_t *triangle, int32_t n,
                           kinematics_rank_t *rank)
{
    int32_t classes[KINEMATICS_UNKNOWNS_MAX] = {0};
    for (int32_t i = 0; i < kinematics_problem_columns(machine); i++) {
        classes[i] = i < KINEMATICS_NUISANCES ? KINEMATICS_RANK_FIRST : KINEMATICS_RANK_NEVER;
    }
    kinematics_rank_find(triangle, classes, KINEMATICS_TOLERANCE * sqrt(3.0 * (double)n), rank);
}

int kinematics_problem_start(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n, double *unknowns, kinematics_triangle_t *triangle)
{
    kinematics_rank_t rank;
    if (machine->tool_is_known) {
        memcpy(&unknowns[3], machine->tool_mm, sizeof machine->tool_mm);
    }
    triangle_of(machine, unknowns, points, n, triangle);
    rank_of_places(machine, triangle, n, &rank);
    return kinematics_problem_solve(machine, points, n, &rank, unknowns, triangle);
}
