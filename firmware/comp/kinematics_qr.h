/*
 * Least squares in fixed memory: rows are turned into a triangle one at a time (Givens), and a
 * rank analysis with column pivoting says which columns depend on which. Task.
 * Source: Golub, Van Loan, Matrix Computations, 5.1.8 and 5.4.1.
 */
#ifndef COMP_KINEMATICS_QR_H
#define COMP_KINEMATICS_QR_H

#include "comp/kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    int32_t columns;
    double  r[KINEMATICS_UNKNOWNS_MAX][KINEMATICS_UNKNOWNS_MAX + 1]; /* and the right-hand side */
    double  left_over;                                               /* sum of squared residuals */
} kinematics_triangle_t;

/* Begin with no row; 1 to KINEMATICS_UNKNOWNS_MAX columns. */
void kinematics_triangle_init(kinematics_triangle_t *triangle, int32_t columns);

/* Take in one row: `columns` values and the right-hand side; `row` is used up. */
void kinematics_triangle_add(kinematics_triangle_t *triangle, double *row);

/* The solution; no column may depend on others. */
void kinematics_triangle_solve(const kinematics_triangle_t *triangle, double *solution);

/* Diagonal of (RᵀR)⁻¹: variances for a residual variance of 1; no column may depend on others. */
void kinematics_triangle_variances(const kinematics_triangle_t *triangle, double *variances);

/* Solve Rᵀ·y = row: the squared length of y is the variance that the solution gives that row. */
void kinematics_triangle_whiten(const kinematics_triangle_t *triangle, const double *row,
                                double *y);

typedef struct {
    int32_t rank;
    int32_t pivots[KINEMATICS_UNKNOWNS_MAX]; /* independent columns */
    int32_t depends[KINEMATICS_UNKNOWNS_MAX];
    double  share[KINEMATICS_UNKNOWNS_MAX][KINEMATICS_UNKNOWNS_MAX]; /* [i][c] of column i in the
                                                                        dependent column c */
} kinematics_rank_t;

enum {
    KINEMATICS_RANK_FIRST = 0,
    KINEMATICS_RANK_SECOND = 1,
    KINEMATICS_RANK_THIRD = 2,
    KINEMATICS_RANK_NEVER = 3
};

/*
 * Pick independent columns, class by class, within a class the longest first. A column of which
 * less than `tolerance` is left depends on those picked; those of KINEMATICS_RANK_NEVER are never
 * picked.
 */
void kinematics_rank_find(const kinematics_triangle_t *triangle, const int32_t *classes,
                          double tolerance, kinematics_rank_t *rank);

#ifdef __cplusplus
}
#endif

#endif
