#include "comp/pretravel_fit.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* The centre's coordinates and the radius. A circle has all four as well: its points lie at a
   height of 0, and so does its centre. */
#define AXES     3
#define HEIGHT   2
#define RADIUS   AXES
#define UNKNOWNS (AXES + 1)

#define ITERATIONS_MAX 50
#define PIVOT_MIN      (1.0e4 * DBL_EPSILON) /* of equations whose coefficients are about 1 */
#define STEP_MIN       (1.0e3 * DBL_EPSILON) /* of the points' spread */

/* Normal equations a·x = b of least squares, added up point by point. */
typedef struct {
    double a[UNKNOWNS][UNKNOWNS];
    double b[UNKNOWNS];
} equations_t;

/* The points seen from their middle, in units of their spread. */
typedef struct {
    const pretravel_point_t *points;
    uint32_t                 n;
    pretravel_shape_t        shape;
    pretravel_point_t        middle;
    double                   spread_um;
} cloud_t;

static equations_t no_equations(pretravel_shape_t shape)
{
    equations_t equations = {0};
    equations.a[HEIGHT][HEIGHT] = shape == PRETRAVEL_CIRCLE ? 1.0 : 0.0;
    return equations;
}

static void add_equation(equations_t *equations, const double row[UNKNOWNS], double right)
{
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int k = 0; k < UNKNOWNS; k++) {
            equations->a[i][k] += row[i] * row[k];
        }
        equations->b[i] += row[i] * right;
    }
}

/* Elimination needs no exchange of rows: a matrix of normal equations is positive, or singular. */
static bool eliminate(equations_t *equations)
{
    for (int i = 0; i < UNKNOWNS; i++) {
        double pivot = equations->a[i][i];
        if (!(pivot > PIVOT_MIN)) {
            return false;
        }
        for (int k = i + 1; k < UNKNOWNS; k++) {
            double factor = equations->a[k][i] / pivot;
            for (int m = i; m < UNKNOWNS; m++) {
                equations->a[k][m] -= factor * equations->a[i][m];
            }
            equations->b[k] -= factor * equations->b[i];
        }
    }
    return true;
}

static bool solve(equations_t *equations, double x[UNKNOWNS])
{
    if (!eliminate(equations)) {
        return false;
    }
    for (int i = UNKNOWNS - 1; i >= 0; i--) {
        double rest = equations->b[i];
        for (int k = i + 1; k < UNKNOWNS; k++) {
            rest -= equations->a[i][k] * x[k];
        }
        x[i] = rest / equations->a[i][i];
    }
    return true;
}

static pretravel_point_t seen_from(const pretravel_point_t *point, const pretravel_point_t *from,
                                   pretravel_shape_t shape)
{
    double z_um = shape == PRETRAVEL_SPHERE ? point->z_um - from->z_um : 0.0;
    return (pretravel_point_t){point->x_um - from->x_um, point->y_um - from->y_um, z_um};
}

static double square_of(const pretravel_point_t *p)
{
    return p->x_um * p->x_um + p->y_um * p->y_um + p->z_um * p->z_um;
}

static cloud_t cloud_of(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape)
{
    cloud_t cloud = {.points = points, .n = n, .shape = shape};
    double  squares = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        cloud.middle.x_um += points[i].x_um / (double)n;
        cloud.middle.y_um += points[i].y_um / (double)n;
        cloud.middle.z_um += shape == PRETRAVEL_SPHERE ? points[i].z_um / (double)n : 0.0;
    }
    for (uint32_t i = 0; i < n; i++) {
        pretravel_point_t off = seen_from(&points[i], &cloud.middle, shape);
        squares += square_of(&off) / (double)n;
    }
    cloud.spread_um = sqrt(squares);
    return cloud;
}

/* Point i without its unit, seen from the middle and then from `centre`; gives its square. */
static double take_point(const cloud_t *cloud, uint32_t i, const double centre[UNKNOWNS],
                         double row[UNKNOWNS])
{
    pretravel_point_t off = seen_from(&cloud->points[i], &cloud->middle, cloud->shape);
    row[0] = off.x_um / cloud->spread_um - centre[0];
    row[1] = off.y_um / cloud->spread_um - centre[1];
    row[HEIGHT] = off.z_um / cloud->spread_um - centre[HEIGHT];
    row[RADIUS] = 1.0;
    return row[0] * row[0] + row[1] * row[1] + row[HEIGHT] * row[HEIGHT];
}

/* Algebraic fit, |p|² = 2·c·p + (r² − |c|²): linear, and near enough to begin with. */
static bool begin_fit(const cloud_t *cloud, double fit[UNKNOWNS])
{
    const double middle[UNKNOWNS] = {0.0};
    double       row[UNKNOWNS];
    equations_t  equations = no_equations(cloud->shape);
    for (uint32_t i = 0; i < cloud->n; i++) {
        double square = take_point(cloud, i, middle, row);
        add_equation(&equations, row, square);
    }
    if (!solve(&equations, fit)) {
        return false;
    }
    for (int axis = 0; axis < AXES; axis++) {
        fit[axis] /= 2.0;
        fit[RADIUS] += fit[axis] * fit[axis];
    }
    fit[RADIUS] = sqrt(fit[RADIUS]);
    return true;
}

/* The step of Gauss and Newton on Σ(|p − c| − r)²; its length, or a negative number if none. */
static double improve_fit(const cloud_t *cloud, double fit[UNKNOWNS])
{
    double      row[UNKNOWNS];
    double      step[UNKNOWNS] = {0.0};
    equations_t equations = no_equations(cloud->shape);
    for (uint32_t i = 0; i < cloud->n; i++) {
        double distance = sqrt(take_point(cloud, i, fit, row));
        for (int axis = 0; axis < AXES; axis++) {
            row[axis] = distance > 0.0 ? row[axis] / distance : 0.0;
        }
        add_equation(&equations, row, distance - fit[RADIUS]);
    }
    if (!solve(&equations, step)) {
        return -1.0;
    }
    double length = 0.0;
    for (int i = 0; i < UNKNOWNS; i++) {
        fit[i] += step[i];
        length += fabs(step[i]);
    }
    return length;
}

static bool find_fit(const cloud_t *cloud, double fit[UNKNOWNS])
{
    double step = begin_fit(cloud, fit) ? 1.0 : -1.0;
    for (int i = 0; i < ITERATIONS_MAX && step > STEP_MIN * (1.0 + fit[RADIUS]); i++) {
        step = improve_fit(cloud, fit);
    }
    return step >= 0.0 && step <= STEP_MIN * (1.0 + fit[RADIUS]);
}

void pretravel_radii_um(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                        const pretravel_fit_t *fit, double *radius_um)
{
    const pretravel_point_t centre = {fit->x_um, fit->y_um, fit->z_um};
    for (uint32_t i = 0; i < n; i++) {
        pretravel_point_t off = seen_from(&points[i], &centre, shape);
        radius_um[i] = sqrt(square_of(&off));
    }
}

static double scatter_um(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                         const pretravel_fit_t *fit)
{
    double squares = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double radius_um = 0.0;
        pretravel_radii_um(&points[i], 1u, shape, fit, &radius_um);
        squares += (radius_um - fit->radius_um) * (radius_um - fit->radius_um);
    }
    return sqrt(squares / (double)n);
}

static bool are_finite(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape)
{
    for (uint32_t i = 0; i < n; i++) {
        bool is_height = shape == PRETRAVEL_CIRCLE || isfinite(points[i].z_um);
        if (!isfinite(points[i].x_um) || !isfinite(points[i].y_um) || !is_height) {
            return false;
        }
    }
    return true;
}

int pretravel_fit(const pretravel_point_t *points, uint32_t n, pretravel_shape_t shape,
                  pretravel_fit_t *fit)
{
    double found[UNKNOWNS] = {0.0};
    if (n < (shape == PRETRAVEL_SPHERE ? 4u : 3u)) {
        return PRETRAVEL_ERR_FEW_POINTS;
    }
    if (!are_finite(points, n, shape)) {
        return PRETRAVEL_ERR_NOT_FINITE;
    }
    const cloud_t cloud = cloud_of(points, n, shape);
    if (!(cloud.spread_um > 0.0) || !find_fit(&cloud, found)) {
        return PRETRAVEL_ERR_CENTRE;
    }
    *fit = (pretravel_fit_t){
        .x_um = cloud.middle.x_um + cloud.spread_um * found[0],
        .y_um = cloud.middle.y_um + cloud.spread_um * found[1],
        .z_um = cloud.middle.z_um + cloud.spread_um * found[HEIGHT],
        .radius_um = cloud.spread_um * found[RADIUS],
    };
    fit->scatter_um = scatter_um(points, n, shape, fit);
    return PRETRAVEL_OK;
}
