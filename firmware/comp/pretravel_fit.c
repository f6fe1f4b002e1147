#include "comp/pretravel_fit.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

#define UNKNOWNS_MAX   4 /* centre and radius */
#define ITERATIONS_MAX 50
#define PIVOT_MIN      (1.0e4 * DBL_EPSILON) /* of equations whose coefficients are about 1 */
#define STEP_MIN       (64.0 * DBL_EPSILON)  /* of the points' spread */

/* Normal equations a·x = b of least squares, added up point by point. */
typedef struct {
    double a[UNKNOWNS_MAX][UNKNOWNS_MAX];
    double b[UNKNOWNS_MAX];
    int    unknowns;
} equations_t;

/* The points seen from their middle, in units of their spread. */
typedef struct {
    const pretravel_point_t *points;
    uint32_t                 n;
    int                      axes;
    double                   middle[3];
    double                   spread_um;
} cloud_t;

static double coordinate_um(const pretravel_point_t *point, int axis)
{
    if (axis == 0) {
        return point->x_um;
    }
    return axis == 1 ? point->y_um : point->z_um;
}

static void add_equation(equations_t *equations, const double *row, double right)
{
    for (int i = 0; i < equations->unknowns; i++) {
        for (int k = 0; k < equations->unknowns; k++) {
            equations->a[i][k] += row[i] * row[k];
        }
        equations->b[i] += row[i] * right;
    }
}

/* Cholesky's square-root-free form; the matrix is symmetric and all but surely positive. */
static bool solve(equations_t *equations, double *x)
{
    const int n = equations->unknowns;
    for (int i = 0; i < n; i++) {
        double pivot = equations->a[i][i];
        if (!(pivot > PIVOT_MIN)) {
            return false;
        }
        for (int k = i + 1; k < n; k++) {
            double factor = equations->a[k][i] / pivot;
            for (int m = i; m < n; m++) {
                equations->a[k][m] -= factor * equations->a[i][m];
            }
            equations->b[k] -= factor * equations->b[i];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        x[i] = equations->b[i];
        for (int k = i + 1; k < n; k++) {
            x[i] -= equations->a[i][k] * x[k];
        }
        x[i] /= equations->a[i][i];
    }
    return true;
}

static void measure_cloud(cloud_t *cloud)
{
    double squares = 0.0;
    for (int axis = 0; axis < cloud->axes; axis++) {
        double mean = 0.0;
        for (uint32_t i = 0; i < cloud->n; i++) {
            mean += coordinate_um(&cloud->points[i], axis) / (double)cloud->n;
        }
        cloud->middle[axis] = mean;
        for (uint32_t i = 0; i < cloud->n; i++) {
            double off = coordinate_um(&cloud->points[i], axis) - mean;
            squares += off * off / (double)cloud->n;
        }
    }
    cloud->spread_um = sqrt(squares);
}

static double scaled(const cloud_t *cloud, uint32_t i, int axis)
{
    return (coordinate_um(&cloud->points[i], axis) - cloud->middle[axis]) / cloud->spread_um;
}

/* Algebraic fit, |p|² = 2·c·p + (r² − |c|²): linear, and near enough to begin with. */
static bool begin_fit(const cloud_t *cloud, double *fit)
{
    equations_t equations = {.unknowns = cloud->axes + 1};
    double      found[UNKNOWNS_MAX] = {0.0};
    for (uint32_t i = 0; i < cloud->n; i++) {
        double row[UNKNOWNS_MAX] = {0.0};
        double square = 0.0;
        for (int axis = 0; axis < cloud->axes; axis++) {
            row[axis] = scaled(cloud, i, axis);
            square += row[axis] * row[axis];
        }
        row[cloud->axes] = 1.0;
        add_equation(&equations, row, square);
    }
    if (!solve(&equations, found)) {
        return false;
    }
    double radius_square = found[cloud->axes];
    for (int axis = 0; axis < cloud->axes; axis++) {
        fit[axis] = found[axis] / 2.0;
        radius_square += fit[axis] * fit[axis];
    }
    fit[cloud->axes] = sqrt(radius_square);
    return true;
}

/* The step of Gauss and Newton on Σ(|p − c| − r)²; its length, or a negative number if none. */
static double improve_fit(const cloud_t *cloud, double *fit)
{
    equations_t equations = {.unknowns = cloud->axes + 1};
    double      step[UNKNOWNS_MAX] = {0.0};
    for (uint32_t i = 0; i < cloud->n; i++) {
        double row[UNKNOWNS_MAX] = {0.0};
        double square = 0.0;
        for (int axis = 0; axis < cloud->axes; axis++) {
            row[axis] = scaled(cloud, i, axis) - fit[axis];
            square += row[axis] * row[axis];
        }
        double distance = sqrt(square);
        for (int axis = 0; axis < cloud->axes; axis++) {
            row[axis] = distance > 0.0 ? row[axis] / distance : 0.0;
        }
        row[cloud->axes] = 1.0;
        add_equation(&equations, row, distance - fit[cloud->axes]);
    }
    if (!solve(&equations, step)) {
        return -1.0;
    }
    double length = 0.0;
    for (int i = 0; i < equations.unknowns; i++) {
        fit[i] += step[i];
        length += fabs(step[i]);
    }
    return length;
}

static bool find_fit(const cloud_t *cloud, double *fit)
{
    double step = begin_fit(cloud, fit) ? 1.0 : -1.0;
    for (int i = 0; i < ITERATIONS_MAX && step > STEP_MIN * (1.0 + fit[cloud->axes]); i++) {
        step = improve_fit(cloud, fit);
    }
    return step >= 0.0 && step <= STEP_MIN * (1.0 + fit[cloud->axes]);
}

static double distance_um(const pretravel_point_t *point, pretravel_shape_t shape,
                          const pretravel_fit_t *fit)
{
    double x_um = point->x_um - fit->x_um;
    double y_um = point->y_um - fit->y_um;
    double z_um = shape == PRETRAVEL_SPHERE ? point->z_um - fit->z_um : 0.0;
    return sqrt(x_um * x_um + y_um * y_um + z_um * z_um);
}

void pretravel_radii_um(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                        const pretravel_fit_t *fit, double *radius_um)
{
    for (uint32_t i = 0; i < n; i++) {
        radius_um[i] = distance_um(&points[i], shape, fit);
    }
}

static double scatter_um(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                         const pretravel_fit_t *fit)
{
    double squares = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double off = distance_um(&points[i], shape, fit) - fit->radius_um;
        squares += off * off;
    }
    return sqrt(squares / (double)n);
}

static bool are_finite(const pretravel_point_t *points, uint32_t n, int axes)
{
    for (uint32_t i = 0; i < n; i++) {
        for (int axis = 0; axis < axes; axis++) {
            if (!isfinite(coordinate_um(&points[i], axis))) {
                return false;
            }
        }
    }
    return true;
}

int pretravel_fit(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                  pretravel_fit_t *fit)
{
    cloud_t cloud = {.points = points, .n = n, .axes = (int)shape};
    double  found[UNKNOWNS_MAX] = {0.0};
    if (n < (uint32_t)cloud.axes + 1u) {
        return PRETRAVEL_ERR_FEW_POINTS;
    }
    if (!are_finite(points, n, cloud.axes)) {
        return PRETRAVEL_ERR_NOT_FINITE;
    }
    measure_cloud(&cloud);
    if (!(cloud.spread_um > 0.0) || !find_fit(&cloud, found)) {
        return PRETRAVEL_ERR_CENTRE;
    }
    *fit = (pretravel_fit_t){
        .x_um = cloud.middle[0] + cloud.spread_um * found[0],
        .y_um = cloud.middle[1] + cloud.spread_um * found[1],
        .z_um = shape == PRETRAVEL_SPHERE ? cloud.middle[2] + cloud.spread_um * found[2] : 0.0,
        .radius_um = cloud.spread_um * found[cloud.axes],
    };
    fit->scatter_um = scatter_um(points, n, shape, fit);
    return PRETRAVEL_OK;
}
