#include "cycle/sphere_probe.h"

#include <math.h>

#define PI              3.14159265358979323846
#define STEPS_A_TOUCH   4    /* above the touch's start, at its start, touch, above again */
#define X_IS_ALONG      0.9  /* a tool axis this much along X has its reference angle from Y */
#define DETERMINANT_MIN 1e-6 /* of a circle's normal equations, in units of the contact radius */

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The part of `axis` across the tool axis is reference angle 0°; 90° follows right-handed. */
static void lay_plane(sphere_probe_t *probe)
{
    const double *t = probe->config.tool_axis;
    uint8_t       axis = (uint8_t)(fabs(t[0]) >= X_IS_ALONG);
    double       *u = probe->in_plane[0];
    double       *v = probe->in_plane[1];
    double        across = sqrt(1.0 - t[axis] * t[axis]);

    for (uint8_t i = 0u; i < 3u; i++) {
        u[i] = ((i == axis ? 1.0 : 0.0) - t[axis] * t[i]) / across;
    }
    v[0] = t[1] * u[2] - t[2] * u[1];
    v[1] = t[2] * u[0] - t[0] * u[2];
    v[2] = t[0] * u[1] - t[1] * u[0];
}

void sphere_probe_start(sphere_probe_t *probe, const sphere_probe_config_t *config)
{
    probe->config = *config;
    probe->step = 0u;
    probe->touched = 0u;
    lay_plane(probe);
}

/* From the centre of the sphere outwards, length 1. */
static void outwards(const sphere_probe_t *probe, uint8_t touch, double *direction)
{
    const sphere_probe_config_t *config = &probe->config;
    double degrees = config->reference_deg + 360.0 / config->touches * (touch - 1);
    double angle = degrees * (PI / 180.0);

    for (uint8_t i = 0u; i < 3u; i++) {
        direction[i] =
            touch == 0u ? config->tool_axis[i]
                        : cos(angle) * probe->in_plane[0][i] + sin(angle) * probe->in_plane[1][i];
    }
}

/*
 * A touch on the equator begins and ends above its start, so that the way to the next one leads
 * over the sphere and not through it. Above the pole start and above are one point.
 */
bool sphere_probe_next(sphere_probe_t *probe, sphere_probe_step_t *step)
{
    const sphere_probe_config_t *config = &probe->config;
    uint8_t                      touch = probe->step / STEPS_A_TOUCH;
    uint8_t                      phase = probe->step % STEPS_A_TOUCH;
    double                       distance = config->contact_mm + config->stand_off_mm;
    double                       out[3];

    if (touch > config->touches) {
        return false;
    }
    outwards(probe, touch, out);
    bool is_above = touch > 0u && (phase == 0u || phase == STEPS_A_TOUCH - 1);
    for (uint8_t i = 0u; i < 3u; i++) {
        double beside = out[i] + (is_above ? config->tool_axis[i] : 0.0);
        step->target_mm[i] = config->centre_mm[i] + distance * beside;
        step->direction[i] = -out[i];
    }
    step->is_touch = phase == 2u;
    probe->step++;
    return true;
}

void sphere_probe_touched(sphere_probe_t *probe, const double *touched_mm)
{
    for (uint8_t i = 0u; i < 3u; i++) {
        probe->touched_mm[probe->touched][i] = touched_mm[i];
    }
    probe->touched++;
}

/* ---- centre and radius ---- */

/* A touched point in units of the contact radius, from the expected centre: u, v and height. */
static void local(const sphere_probe_t *probe, uint8_t touch, double *point)
{
    double from[3];
    for (uint8_t i = 0u; i < 3u; i++) {
        from[i] =
            (probe->touched_mm[touch][i] - probe->config.centre_mm[i]) / probe->config.contact_mm;
    }
    point[0] = dot(from, probe->in_plane[0]);
    point[1] = dot(from, probe->in_plane[1]);
    point[2] = dot(from, probe->config.tool_axis);
}

/* Sums over the touches on the equator. */
typedef struct {
    double u, v, height, square;
    double uu, uv, vv, u_square, v_square;
} sums_t;

static sums_t sum_up(const sphere_probe_t *probe, const double *mean)
{
    sums_t sums = {0};
    for (uint8_t i = 1u; i <= probe->config.touches; i++) {
        double p[3];
        local(probe, i, p);
        double u = p[0] - mean[0];
        double v = p[1] - mean[1];
        sums.u += u;
        sums.v += v;
        sums.height += p[2];
        sums.square += u * u + v * v;
        sums.uu += u * u;
        sums.uv += u * v;
        sums.vv += v * v;
        sums.u_square += u * (u * u + v * v);
        sums.v_square += v * (u * u + v * v);
    }
    return sums;
}

/* The circle that minimises Σ(u² + v² − 2·a·u − 2·b·v − c)², around the mean of the points. */
static bool fit_circle(const sphere_probe_t *probe, double *centre, double *height, double *radius)
{
    double       n = probe->config.touches;
    sums_t       sums = sum_up(probe, (const double[]){0.0, 0.0});
    const double mean[2] = {sums.u / n, sums.v / n};

    *height = sums.height / n;
    sums = sum_up(probe, mean);
    double determinant = sums.uu * sums.vv - sums.uv * sums.uv;
    if (!(determinant > DETERMINANT_MIN)) {
        return false;
    }
    double a = (sums.u_square * sums.vv - sums.v_square * sums.uv) / (2.0 * determinant);
    double b = (sums.v_square * sums.uu - sums.u_square * sums.uv) / (2.0 * determinant);
    centre[0] = mean[0] + a;
    centre[1] = mean[1] + b;
    *radius = sqrt(sums.square / n + a * a + b * b);
    return true;
}

/*
 * Of the sphere through the circle and the pole, with no radius taken as known: r² + (h − z)² =
 * d² + (p − z)², d the pole's distance from the axis of the circle.
 */
static double radius_through(double circle_radius, double circle_height, double pole_off_square,
                             double pole_height)
{
    double circle = circle_radius * circle_radius + circle_height * circle_height;
    double pole = pole_off_square + pole_height * pole_height;
    double below = circle_height - (pole - circle) / (2.0 * (pole_height - circle_height));
    return sqrt(circle_radius * circle_radius + below * below);
}

bool sphere_probe_solve(const sphere_probe_t *probe, double *centre_mm, double *contact_mm)
{
    const sphere_probe_config_t *config = &probe->config;
    double                       centre[3];
    double                       height;
    double                       radius;
    double                       pole[3];

    if (probe->touched != 1u + config->touches || !fit_circle(probe, centre, &height, &radius)) {
        return false;
    }
    local(probe, 0u, pole);
    double du = pole[0] - centre[0];
    double dv = pole[1] - centre[1];
    double rise = 1.0 - du * du - dv * dv;
    if (!(rise > 0.0)) {
        return false;
    }
    centre[2] = pole[2] - sqrt(rise);
    for (uint8_t i = 0u; i < 3u; i++) {
        centre_mm[i] =
            config->centre_mm[i] + config->contact_mm * (centre[0] * probe->in_plane[0][i] +
                                                         centre[1] * probe->in_plane[1][i] +
                                                         centre[2] * config->tool_axis[i]);
    }
    *contact_mm = config->contact_mm * radius_through(radius, height, du * du + dv * dv, pole[2]);
    return isfinite(*contact_mm); /* not so with a NaN among the heights */
}
