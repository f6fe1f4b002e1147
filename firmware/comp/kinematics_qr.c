#include "comp/kinematics_qr.h"

#include <math.h>
#include <string.h>

void kinematics_triangle_init(kinematics_triangle_t *triangle, int32_t columns)
{
    memset(triangle, 0, sizeof *triangle);
    triangle->columns = columns;
}

void kinematics_triangle_add(kinematics_triangle_t *triangle, double *row)
{
    int32_t n = triangle->columns;
    for (int32_t i = 0; i < n; i++) {
        double *own = triangle->r[i];
        double  length = sqrt(own[i] * own[i] + row[i] * row[i]);
        if (!(fabs(row[i]) > 0.0) || !(length > 0.0)) {
            continue;
        }
        double c = own[i] / length;
        double s = row[i] / length;
        for (int32_t k = i; k <= n; k++) {
            double mine = own[k];
            own[k] = c * mine + s * row[k];
            row[k] = c * row[k] - s * mine;
        }
    }
    triangle->left_over += row[n] * row[n];
}

void kinematics_triangle_solve(const kinematics_triangle_t *triangle, double *solution)
{
    int32_t n = triangle->columns;
    for (int32_t i = n - 1; i >= 0; i--) {
        double sum = triangle->r[i][n];
        for (int32_t k = i + 1; k < n; k++) {
            sum -= triangle->r[i][k] * solution[k];
        }
        solution[i] = sum / triangle->r[i][i];
    }
}

void kinematics_triangle_whiten(const kinematics_triangle_t *triangle, const double *row, double *y)
{
    for (int32_t i = 0; i < triangle->columns; i++) {
        double sum = row[i];
        for (int32_t k = 0; k < i; k++) {
            sum -= triangle->r[k][i] * y[k];
        }
        y[i] = sum / triangle->r[i][i];
    }
}

void kinematics_triangle_variances(const kinematics_triangle_t *triangle, double *variances)
{
    int32_t n = triangle->columns;
    for (int32_t j = 0; j < n; j++) {
        double unit[KINEMATICS_UNKNOWNS_MAX] = {0.0};
        double y[KINEMATICS_UNKNOWNS_MAX];
        unit[j] = 1.0;
        kinematics_triangle_whiten(triangle, unit, y);
        variances[j] = 0.0;
        for (int32_t k = j; k < n; k++) {
            variances[j] += y[k] * y[k];
        }
    }
}

/* Columns in work, one a row, and the triangle that the picked ones make. */
typedef struct {
    int32_t n;
    int32_t picked[KINEMATICS_UNKNOWNS_MAX];
    double  columns[KINEMATICS_UNKNOWNS_MAX][KINEMATICS_UNKNOWNS_MAX];
    double  upper[KINEMATICS_UNKNOWNS_MAX][KINEMATICS_UNKNOWNS_MAX];
} picking_t;

static double length_of(const double *v, int32_t n)
{
    double sum = 0.0;
    for (int32_t k = 0; k < n; k++) {
        sum += v[k] * v[k];
    }
    return sqrt(sum);
}

static int32_t longest(const picking_t *work, const int32_t *classes, int32_t class_now,
                       double *length)
{
    int32_t best = -1;
    *length = 0.0;
    for (int32_t j = 0; j < work->n; j++) {
        double now = length_of(work->columns[j], work->n);
        if (!work->picked[j] && classes[j] == class_now && now > *length) {
            best = j;
            *length = now;
        }
    }
    return best;
}

/* Take the picked column out of all that are left (modified Gram-Schmidt). */
static void pick(picking_t *work, int32_t step, int32_t best, double length)
{
    double *direction = work->columns[best];
    work->picked[best] = 1;
    work->upper[step][best] = length;
    for (int32_t k = 0; k < work->n; k++) {
        direction[k] /= length;
    }
    for (int32_t j = 0; j < work->n; j++) {
        if (work->picked[j]) {
            continue;
        }
        double along = 0.0;
        for (int32_t k = 0; k < work->n; k++) {
            along += direction[k] * work->columns[j][k];
        }
        work->upper[step][j] = along;
        for (int32_t k = 0; k < work->n; k++) {
            work->columns[j][k] -= along * direction[k];
        }
    }
}

static void shares(const picking_t *work, int32_t column, kinematics_rank_t *rank)
{
    for (int32_t i = rank->rank - 1; i >= 0; i--) {
        double sum = work->upper[i][column];
        for (int32_t k = i + 1; k < rank->rank; k++) {
            sum -= work->upper[i][rank->pivots[k]] * rank->share[rank->pivots[k]][column];
        }
        rank->share[rank->pivots[i]][column] = sum / work->upper[i][rank->pivots[i]];
    }
}

void kinematics_rank_find(const kinematics_triangle_t *triangle, const int32_t *classes,
                          double tolerance, kinematics_rank_t *rank)
{
    picking_t work = {.n = triangle->columns};
    memset(rank, 0, sizeof *rank);
    for (int32_t j = 0; j < work.n; j++) {
        for (int32_t k = 0; k <= j; k++) {
            work.columns[j][k] = triangle->r[k][j];
        }
    }
    for (int32_t class_now = 0; class_now < KINEMATICS_RANK_NEVER; class_now++) {
        double  length = 0.0;
        int32_t best = longest(&work, classes, class_now, &length);
        while (best >= 0 && length >= tolerance) {
            pick(&work, rank->rank, best, length);
            rank->pivots[rank->rank++] = best;
            best = longest(&work, classes, class_now, &length);
        }
    }
    for (int32_t j = 0; j < work.n; j++) {
        if (!work.picked[j]) {
            rank->depends[j] = 1;
            shares(&work, j, rank);
        }
    }
}
