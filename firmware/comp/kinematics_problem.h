/*
 * The least-squares problem of kinematics.h, in columns scaled to mm: lengths as they are, angles
 * as the arc at KINEMATICS_LEVER_MM. Only kinematics*.c use it. Task.
 */
#ifndef COMP_KINEMATICS_PROBLEM_H
#define COMP_KINEMATICS_PROBLEM_H

#include <stdbool.h>

#include "comp/kinematics.h"
#include "comp/kinematics_qr.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KINEMATICS_LEVER_MM  100.0
#define KINEMATICS_TOLERANCE 1.0e-4 /* root mean square effect below which a column is none */

/* KINEMATICS_OK, or what is wrong with machine or points. */
int kinematics_problem_check(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n);

int32_t kinematics_problem_columns(const kinematics_machine_t *machine);

bool kinematics_problem_tip_is_unknown(const kinematics_machine_t *machine);

/* Scaled unknown per unknown in mm or rad. */
double kinematics_problem_scale(int32_t column);

/* Whether a parameter (0 is the first of the first axis) is to be fitted. */
bool kinematics_problem_is_free(const kinematics_machine_t *machine, int32_t parameter);

/* Rows of a point: slopes of all columns, scaled, then measured minus expected in mm; across the
 * tool, and along it as axial_scatter weighs that. */
void kinematics_problem_rows(const kinematics_machine_t *machine, const double *unknowns,
                             const kinematics_point_t *point,
                             double                    rows[3][KINEMATICS_UNKNOWNS_MAX + 1]);

/* Take points into a triangle of all columns. */
void kinematics_problem_add_all(const kinematics_machine_t *machine, const double *unknowns,
                                const kinematics_point_t *points, int32_t n,
                                kinematics_triangle_t *triangle);

/* Which columns the `n` points in the triangle determine; what is not free is never picked. */
void kinematics_problem_rank_of(const kinematics_machine_t  *machine,
                                const kinematics_triangle_t *triangle, int32_t n,
                                kinematics_rank_t *rank);

/* The same for `points`. */
void kinematics_problem_rank(const kinematics_machine_t *machine, const double *unknowns,
                             const kinematics_point_t *points, int32_t n, kinematics_rank_t *rank);

/* Find the shares anew where `unknowns` are now; what is picked stays picked. */
void kinematics_problem_shares(const kinematics_machine_t *machine, const double *unknowns,
                               const kinematics_point_t *points, int32_t n,
                               kinematics_rank_t *rank);

/* Place sphere and tip as the believed axes have them. */
int kinematics_problem_start(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n, double *unknowns, kinematics_triangle_t *triangle);

/* Gauss-Newton over the picked columns; `triangle` is that of the last step, in their order. */
int kinematics_problem_solve(const kinematics_machine_t *machine, const kinematics_point_t *points,
                             int32_t n, const kinematics_rank_t *rank, double *unknowns,
                             kinematics_triangle_t *triangle);

/* Tell in `result` what is determined and what not; values stay 0. */
void kinematics_problem_describe(const kinematics_machine_t *machine, const kinematics_rank_t *rank,
                                 int32_t points, kinematics_result_t *result);

/* Tell how much of each parameter goes into what shows at no position. */
void kinematics_problem_tell_amounts(const kinematics_rank_t *rank, kinematics_result_t *result);

#ifdef __cplusplus
}
#endif

#endif
