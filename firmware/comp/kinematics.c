#include "comp/kinematics.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "comp/kinematics_chain.h"
#include "comp/kinematics_coverage.h"
#include "comp/kinematics_problem.h"

#define UM_PER_MM      1000.0
#define ARCSEC_PER_RAD 206264.80624709636
#define SHARE_SEEN     1.0e-3 /* a smaller part of one parameter in another is not told */

static bool is_zero_error(int32_t parameter)
{
    return parameter % KINEMATICS_OF_AXIS == KINEMATICS_CHAIN_ZERO;
}

static void describe(const kinematics_machine_t *machine, kinematics_result_t *result)
{
    result->parameters_count = KINEMATICS_OF_AXIS * machine->axes_count;
    for (int32_t i = 0; i < result->parameters_count; i++) {
        const kinematics_axis_t *axis = &machine->axes[i / KINEMATICS_OF_AXIS];
        int32_t                  which = i % KINEMATICS_OF_AXIS;
        kinematics_parameter_t  *parameter = &result->parameters[i];
        parameter->is_angle = which >= KINEMATICS_CHAIN_TILT;
        parameter->name[0] =
            (char)((parameter->is_angle ? 'A' : 'X') + kinematics_chain_coordinate(axis, which));
        parameter->name[1] = 'O';
        parameter->name[2] = (char)axis->letter;
    }
}

static double unit_of(const kinematics_parameter_t *parameter)
{
    return parameter->is_angle ? ARCSEC_PER_RAD / KINEMATICS_LEVER_MM : UM_PER_MM;
}

static bool shares_any(const kinematics_rank_t *rank, int32_t first, int32_t column)
{
    bool any = false;
    for (int32_t k = 0; k < 3; k++) {
        any = any || fabs(rank->share[first + k][column]) > SHARE_SEEN;
    }
    return any;
}

/* The direction in which the dependent column and those it depends on cancel. */
static void tell_blind(const kinematics_rank_t *rank, int32_t index, kinematics_result_t *result)
{
    int32_t             column = KINEMATICS_NUISANCES + index;
    kinematics_blind_t *blind = &result->blind[result->blind_count++];
    blind->parameter = index;
    blind->with_sphere = shares_any(rank, 0, column);
    blind->with_tip = shares_any(rank, 3, column);
    for (int32_t i = 0; i < result->parameters_count; i++) {
        double share = rank->share[KINEMATICS_NUISANCES + i][column];
        blind->named[i] = i == index || fabs(share) > SHARE_SEEN;
    }
}

void kinematics_problem_tell_amounts(const kinematics_rank_t *rank, kinematics_result_t *result)
{
    for (int32_t b = 0; b < result->blind_count; b++) {
        kinematics_blind_t *blind = &result->blind[b];
        double              own_unit = unit_of(&result->parameters[blind->parameter]);
        for (int32_t i = 0; i < result->parameters_count; i++) {
            double share =
                rank->share[KINEMATICS_NUISANCES + i][KINEMATICS_NUISANCES + blind->parameter];
            blind->per_unit[i] = -share * unit_of(&result->parameters[i]) / own_unit;
        }
        blind->per_unit[blind->parameter] = 1.0;
    }
}

/* Whether a determined parameter goes with others that are free and not determined. */
static bool is_combined(const kinematics_machine_t *machine, const kinematics_rank_t *rank,
                        int32_t index)
{
    bool combined = false;
    for (int32_t i = 0; i < KINEMATICS_OF_AXIS * machine->axes_count; i++) {
        double share = rank->share[KINEMATICS_NUISANCES + index][KINEMATICS_NUISANCES + i];
        bool   goes_with = kinematics_problem_is_free(machine, i) && fabs(share) > SHARE_SEEN;
        combined = combined || (goes_with && !is_zero_error(i));
    }
    return combined;
}

/* A zero that is not fitted is not held, but no positions would determine it. */
static void tell_states(const kinematics_machine_t *machine, const kinematics_rank_t *rank,
                        kinematics_result_t *result)
{
    for (int32_t i = 0; i < result->parameters_count; i++) {
        kinematics_parameter_t *parameter = &result->parameters[i];
        if (!rank->depends[KINEMATICS_NUISANCES + i]) {
            parameter->state =
                is_combined(machine, rank, i) ? KINEMATICS_COMBINED : KINEMATICS_DETERMINED;
        } else if (kinematics_problem_is_free(machine, i) || is_zero_error(i)) {
            tell_blind(rank, i, result);
        } else {
            parameter->state = KINEMATICS_HELD;
        }
    }
}

void kinematics_problem_describe(const kinematics_machine_t *machine, const kinematics_rank_t *rank,
                                 int32_t points, kinematics_result_t *result)
{
    memset(result, 0, sizeof *result);
    describe(machine, result);
    tell_states(machine, rank, result);
    result->unknowns = 3 + (kinematics_problem_tip_is_unknown(machine) ? 3 : 0) +
                       KINEMATICS_OF_AXIS * machine->axes_count;
    result->rank = rank->rank;
    result->freedom = 3 * points - rank->rank;
    kinematics_problem_tell_amounts(rank, result);
}

static void tell_values(const kinematics_rank_t *rank, const kinematics_triangle_t *triangle,
                        const double *unknowns, kinematics_result_t *result)
{
    double variances[KINEMATICS_UNKNOWNS_MAX];
    double scatter_mm = sqrt(triangle->left_over / (double)result->freedom);
    double widened_mm = scatter_mm * kinematics_coverage_factor(result->freedom);
    kinematics_triangle_variances(triangle, variances);
    result->residual_um = UM_PER_MM * scatter_mm;
    memcpy(result->sphere_mm, unknowns, sizeof result->sphere_mm);
    memcpy(result->tip_mm, unknowns + 3, sizeof result->tip_mm);
    for (int32_t i = 0; i < rank->rank; i++) {
        int32_t column = rank->pivots[i];
        if (column >= KINEMATICS_NUISANCES) {
            kinematics_parameter_t *parameter = &result->parameters[column - KINEMATICS_NUISANCES];
            parameter->value =
                unknowns[column] * kinematics_problem_scale(column) * unit_of(parameter);
            parameter->uncertainty = widened_mm * sqrt(variances[i]) * unit_of(parameter);
        }
    }
}

static bool is_finite(double value)
{
    return fabs(value) <= DBL_MAX;
}

/* Squares of finite numbers may be none. */
static bool all_is_finite(const kinematics_result_t *result)
{
    bool good = is_finite(result->residual_um);
    for (int32_t k = 0; k < 3; k++) {
        good = good && is_finite(result->sphere_mm[k]) && is_finite(result->tip_mm[k]);
    }
    for (int32_t i = 0; i < result->parameters_count; i++) {
        good = good && is_finite(result->parameters[i].value) &&
               is_finite(result->parameters[i].uncertainty);
    }
    return good;
}

int kinematics_fit(const kinematics_machine_t *machine, const kinematics_point_t *points, int32_t n,
                   kinematics_result_t *result)
{
    double                unknowns[KINEMATICS_UNKNOWNS_MAX] = {0.0};
    kinematics_triangle_t triangle;
    kinematics_rank_t     rank;
    int                   code = kinematics_problem_check(machine, points, n);
    if (code == KINEMATICS_OK) {
        code = kinematics_problem_start(machine, points, n, unknowns, &triangle);
    }
    if (code != KINEMATICS_OK) {
        return code;
    }
    kinematics_problem_rank(machine, unknowns, points, n, &rank);
    if (3 * n <= rank.rank) {
        return KINEMATICS_ERR_TOO_FEW;
    }
    code = kinematics_problem_solve(machine, points, n, &rank, unknowns, &triangle);
    if (code == KINEMATICS_OK) {
        kinematics_problem_describe(machine, &rank, n, result);
        tell_values(&rank, &triangle, unknowns, result);
        kinematics_problem_shares(machine, unknowns, points, n, &rank);
        kinematics_problem_tell_amounts(&rank, result);
        code = all_is_finite(result) ? KINEMATICS_OK : KINEMATICS_ERR_NO_FIT;
    }
    return code;
}
