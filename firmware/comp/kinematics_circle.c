#include "comp/kinematics_circle.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "comp/kinematics_coverage.h"

#define RAD_PER_DEG 0.017453292519943295
#define SPREAD_MIN  1.0e-8 /* of e^{iθ} about its mean, squared: 0.0001 rad */
#define FLAT_MIN    1.0e-8 /* of the circle's smaller spread to the larger, squared */

/* Two directions in the plane and the axis, right-handed. */
typedef struct {
    double along[3][3];
} frame_t;

/* Sums over the points; u, v: position in the plane; w: along the axis; c, s: of e^{iθ}. */
typedef struct {
    double n, c, s, u, v, w;
} means_t;

static void cross(const double *a, const double *b, double *out)
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void frame_of(const double *direction, frame_t *frame)
{
    double helper[3] = {0.0, 0.0, 0.0};
    helper[fabs(direction[0]) < 0.6 ? 0 : 1] = 1.0;
    memcpy(frame->along[2], direction, sizeof frame->along[2]);
    cross(direction, helper, frame->along[1]);
    double *v = frame->along[1];
    double  length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++) {
        v[k] /= length;
    }
    cross(v, direction, frame->along[0]);
}

/* Cosine and sine of the angle, then the position in the frame. */
static void view(const frame_t *frame, int32_t axis, const kinematics_point_t *point, double *out)
{
    double angle_rad = point->angle_deg[axis] * RAD_PER_DEG;
    out[0] = cos(angle_rad);
    out[1] = sin(angle_rad);
    for (int k = 0; k < 3; k++) {
        const double *e = frame->along[k];
        const double *p = point->position_mm;
        out[2 + k] = e[0] * p[0] + e[1] * p[1] + e[2] * p[2];
    }
}

static means_t means_of(const frame_t *frame, int32_t axis, const kinematics_point_t *points,
                        int32_t n)
{
    means_t means = {.n = (double)n};
    for (int32_t i = 0; i < n; i++) {
        double x[5];
        view(frame, axis, &points[i], x);
        means.c += x[0] / means.n;
        means.s += x[1] / means.n;
        means.u += x[2] / means.n;
        means.v += x[3] / means.n;
        means.w += x[4] / means.n;
    }
    return means;
}

/* What the regressions need, about the means: Σ|e|², Σ ē·p, and the products of w, c and s. */
typedef struct {
    double spread, re, im;
    double cc, cs, ss, cw, sw;
} moments_t;

static moments_t moments_of(const frame_t *frame, int32_t axis, const kinematics_point_t *points,
                            int32_t n, const means_t *means)
{
    moments_t m = {0};
    for (int32_t i = 0; i < n; i++) {
        double x[5];
        view(frame, axis, &points[i], x);
        double c = x[0] - means->c;
        double s = x[1] - means->s;
        double u = x[2] - means->u;
        double v = x[3] - means->v;
        double w = x[4] - means->w;
        m.spread += c * c + s * s;
        m.re += c * u + s * v;
        m.im += c * v - s * u;
        m.cc += c * c;
        m.cs += c * s;
        m.ss += s * s;
        m.cw += c * w;
        m.sw += s * w;
    }
    return m;
}

/* Slopes of the axial coordinate over the circle turn the axis: n ∝ n₀ − a·e_u − b·e_v. */
static void find_direction(const frame_t *frame, const moments_t *m, double re, double im,
                           kinematics_circle_t *circle)
{
    double square = re * re + im * im;
    double determinant = m->cc * m->ss - m->cs * m->cs;
    memcpy(circle->direction, frame->along[2], sizeof circle->direction);
    if (!(square > 0.0) || !(determinant > FLAT_MIN * m->spread * m->spread)) {
        return;
    }
    double by_c = (m->cw * m->ss - m->sw * m->cs) / determinant;
    double by_s = (m->sw * m->cc - m->cw * m->cs) / determinant;
    double a = (by_c * re - by_s * im) / square;
    double b = (by_c * im + by_s * re) / square;
    double length = sqrt(1.0 + a * a + b * b);
    for (int k = 0; k < 3; k++) {
        circle->direction[k] =
            (frame->along[2][k] - a * frame->along[0][k] - b * frame->along[1][k]) / length;
    }
    circle->direction_is_known = 1;
}

static double residuals(const frame_t *frame, int32_t axis, const kinematics_point_t *points,
                        int32_t n, const means_t *means, double re, double im)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) {
        double x[5];
        view(frame, axis, &points[i], x);
        double c = x[0] - means->c;
        double s = x[1] - means->s;
        double du = x[2] - means->u - (re * c - im * s);
        double dv = x[3] - means->v - (re * s + im * c);
        sum += du * du + dv * dv;
    }
    return sum;
}

static bool is_finite(const kinematics_point_t *points, int32_t axis, int32_t n)
{
    bool good = true;
    for (int32_t i = 0; i < n; i++) {
        good = good && fabs(points[i].angle_deg[axis]) <= DBL_MAX;
        for (int k = 0; k < 3; k++) {
            good = good && fabs(points[i].position_mm[k]) <= DBL_MAX;
        }
    }
    return good;
}

int kinematics_circle_fit(const double direction[3], int32_t axis, const kinematics_point_t *points,
                          int32_t n, kinematics_circle_t *circle)
{
    frame_t frame;
    memset(circle, 0, sizeof *circle);
    if (!is_finite(points, axis, n)) {
        return KINEMATICS_ERR_POINT;
    }
    if (n < 2) {
        return KINEMATICS_ERR_TOO_FEW;
    }
    frame_of(direction, &frame);
    means_t   means = means_of(&frame, axis, points, n);
    moments_t m = moments_of(&frame, axis, points, n, &means);
    if (!(m.spread > SPREAD_MIN)) {
        return KINEMATICS_ERR_TOO_FEW;
    }
    double re = m.re / m.spread;
    double im = m.im / m.spread;
    double u = means.u - (re * means.c - im * means.s);
    double v = means.v - (re * means.s + im * means.c);
    for (int k = 0; k < 3; k++) {
        circle->centre_mm[k] =
            u * frame.along[0][k] + v * frame.along[1][k] + means.w * frame.along[2][k];
    }
    circle->radius_mm = sqrt(re * re + im * im);
    find_direction(&frame, &m, re, im, circle);
    int32_t freedom = 2 * n - 4;
    if (freedom > 0) {
        double sum = residuals(&frame, axis, points, n, &means, re, im);
        circle->scatter_mm = sqrt(sum / (double)freedom);
        circle->uncertainty_mm =
            circle->scatter_mm * kinematics_coverage_factor(freedom) / sqrt(m.spread);
    }
    return KINEMATICS_OK;
}
