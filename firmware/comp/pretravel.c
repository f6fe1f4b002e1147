#include "comp/pretravel.h"

#include <math.h>
#include <stdbool.h>

#define S_PER_MIN 60.0

#define RUNS_MIN 3u /* a line through two points has no scatter */

/* False for a NaN as well. */
static bool is_above_zero(double value)
{
    return value > 0.0;
}

/* What a speed adds to the pretravel in τ: mm/min times ms is µm times 60. */
static double delay_um(double speed_mm_min, double tau_ms)
{
    return speed_mm_min * tau_ms / S_PER_MIN;
}

double pretravel_um(double transducer_um, double speed_mm_min, double tau_ms)
{
    return transducer_um + delay_um(speed_mm_min, tau_ms);
}

double pretravel_from_radius_um(double measured_um, double nominal_um, pretravel_side_t side)
{
    return (double)side * (measured_um - nominal_um);
}

typedef struct {
    double mean;
    double min;
    double max;
} extent_t;

/* NaN in all of it if a value is. */
static extent_t extent_of(const double *values, uint32_t n)
{
    extent_t extent = {.mean = 0.0, .min = values[0], .max = values[0]};
    for (uint32_t i = 0; i < n; i++) {
        extent.mean += (values[i] - extent.mean) / ((double)i + 1.0);
        extent.min = values[i] < extent.min ? values[i] : extent.min;
        extent.max = values[i] > extent.max ? values[i] : extent.max;
    }
    return isnan(extent.mean) ? (extent_t){(double)NAN, (double)NAN, (double)NAN} : extent;
}

double pretravel_range_um(const double *radius_um, uint32_t n)
{
    extent_t extent = extent_of(radius_um, n);
    return extent.max - extent.min;
}

static int check_runs(const double *speed_mm_min, const double *mean_radius_um, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        if (!isfinite(speed_mm_min[i]) || !isfinite(mean_radius_um[i])) {
            return PRETRAVEL_ERR_NOT_FINITE;
        }
        if (!is_above_zero(speed_mm_min[i])) {
            return PRETRAVEL_ERR_SPEED;
        }
    }
    if (n < RUNS_MIN) {
        return PRETRAVEL_ERR_FEW_RUNS;
    }
    extent_t speeds = extent_of(speed_mm_min, n);
    return speeds.max > speeds.min ? PRETRAVEL_OK : PRETRAVEL_ERR_ONE_SPEED;
}

/* Of (x, y) about their means. */
typedef struct {
    double mean_x;
    double mean_y;
    double xx;
    double xy;
} moments_t;

static moments_t moments_of(const double *x, const double *y, uint32_t n)
{
    moments_t m = {extent_of(x, n).mean, extent_of(y, n).mean, 0.0, 0.0};
    for (uint32_t i = 0; i < n; i++) {
        m.xx += (x[i] - m.mean_x) * (x[i] - m.mean_x);
        m.xy += (x[i] - m.mean_x) * (y[i] - m.mean_y);
    }
    return m;
}

/* From the residuals themselves: the short formula would cancel. */
static double scatter_about_line(const double *x, const double *y, uint32_t n, const moments_t *m)
{
    double slope = m->xy / m->xx;
    double squares = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double residual = y[i] - m->mean_y - slope * (x[i] - m->mean_x);
        squares += residual * residual;
    }
    return sqrt(squares / ((double)n - 2.0));
}

int pretravel_estimate_tau(const double *speed_mm_min, const double *mean_radius_um, uint32_t n,
                           pretravel_side_t side, pretravel_tau_t *tau)
{
    int code = check_runs(speed_mm_min, mean_radius_um, n);
    if (code != PRETRAVEL_OK) {
        return code;
    }
    moments_t m = moments_of(speed_mm_min, mean_radius_um, n);
    double    slope = m.xy / m.xx;
    double    tau_ms = (double)side * slope * S_PER_MIN;
    if (!is_above_zero(tau_ms)) {
        return PRETRAVEL_ERR_TAU;
    }
    tau->tau_ms = tau_ms;
    tau->scatter_um = scatter_about_line(speed_mm_min, mean_radius_um, n, &m);
    tau->tau_uncertainty_ms = tau->scatter_um / sqrt(m.xx) * S_PER_MIN;
    tau->offset_um = m.mean_y - slope * m.mean_x;
    return PRETRAVEL_OK;
}

static int check_plan(const pretravel_plan_t *plan)
{
    bool has_limits = is_above_zero(plan->speed_max_mm_min) &&
                      is_above_zero(plan->overtravel_speed_mm_min) &&
                      is_above_zero(plan->accel_mm_s2) && is_above_zero(plan->approach_mm);
    if (!isfinite(plan->tau_ms)) {
        return PRETRAVEL_ERR_NOT_FINITE;
    }
    if (!is_above_zero(plan->tau_ms)) {
        return PRETRAVEL_ERR_TAU;
    }
    return has_limits ? PRETRAVEL_OK : PRETRAVEL_ERR_LIMIT;
}

static int check_direction(double radius_um, double speed_mm_min)
{
    if (!isfinite(radius_um) || !isfinite(speed_mm_min)) {
        return PRETRAVEL_ERR_NOT_FINITE;
    }
    return is_above_zero(speed_mm_min) ? PRETRAVEL_OK : PRETRAVEL_ERR_SPEED;
}

static int target_of(const double *radius_um, uint32_t n, const pretravel_plan_t *plan,
                     double *target_um)
{
    extent_t extent = extent_of(radius_um, n);
    switch (plan->target) {
    case PRETRAVEL_TARGET_MAX:
        *target_um = extent.max;
        break;
    case PRETRAVEL_TARGET_MIN:
        *target_um = extent.min;
        break;
    case PRETRAVEL_TARGET_GIVEN:
        *target_um = plan->target_um;
        break;
    case PRETRAVEL_TARGET_MEAN:
    default:
        *target_um = extent.mean;
        break;
    }
    return isfinite(*target_um) ? PRETRAVEL_OK : PRETRAVEL_ERR_NOT_FINITE;
}

/* The ramp is compared in mm²/s², so that an acceleration of INFINITY means none. */
static int check_speed(double speed_mm_min, const pretravel_plan_t *plan)
{
    double speed_mm_s = speed_mm_min / S_PER_MIN;
    if (!is_above_zero(speed_mm_min)) {
        return PRETRAVEL_ERR_TOO_SLOW;
    }
    if (speed_mm_min > plan->speed_max_mm_min) {
        return PRETRAVEL_ERR_TOO_FAST;
    }
    if (speed_mm_min > plan->overtravel_speed_mm_min) {
        return PRETRAVEL_ERR_OVERTRAVEL;
    }
    bool is_reached = speed_mm_s * speed_mm_s < 2.0 * plan->accel_mm_s2 * plan->approach_mm;
    return is_reached ? PRETRAVEL_OK : PRETRAVEL_ERR_RAMP;
}

static double new_speed(double radius_um, double speed_mm_min, double target_um, double tau_ms)
{
    return speed_mm_min + (target_um - radius_um) / tau_ms * S_PER_MIN;
}

static int check_given(const double *radius_um, const double *speed_mm_min, uint32_t n,
                       pretravel_result_t *result)
{
    int code = n > 0u ? PRETRAVEL_OK : PRETRAVEL_ERR_FEW_DIRECTIONS;
    for (uint32_t i = 0; i < n && code == PRETRAVEL_OK; i++) {
        result->where = i;
        code = check_direction(radius_um[i], speed_mm_min[i]);
    }
    return code;
}

static int check_speeds(const double *radius_um, const double *speed_mm_min, uint32_t n,
                        const pretravel_plan_t *plan, pretravel_result_t *result)
{
    int code = PRETRAVEL_OK;
    for (uint32_t i = 0; i < n && code == PRETRAVEL_OK; i++) {
        double speed = new_speed(radius_um[i], speed_mm_min[i], result->target_um, plan->tau_ms);
        result->where = i;
        code = check_speed(speed, plan);
    }
    return code;
}

int pretravel_speed_table(const double *radius_um, const double *speed_mm_min, uint32_t n,
                          const pretravel_plan_t *plan, double *new_speed_mm_min,
                          pretravel_result_t *result)
{
    *result = (pretravel_result_t){.target_um = (double)NAN, .where = 0u};
    int code = check_plan(plan);
    if (code == PRETRAVEL_OK) {
        code = check_given(radius_um, speed_mm_min, n, result);
    }
    if (code == PRETRAVEL_OK) {
        code = target_of(radius_um, n, plan, &result->target_um);
    }
    if (code == PRETRAVEL_OK) {
        code = check_speeds(radius_um, speed_mm_min, n, plan, result);
    }
    if (code != PRETRAVEL_OK) {
        return code;
    }
    for (uint32_t i = 0; i < n; i++) {
        new_speed_mm_min[i] =
            new_speed(radius_um[i], speed_mm_min[i], result->target_um, plan->tau_ms);
    }
    return PRETRAVEL_OK;
}

void pretravel_predict_um(const double *radius_um, const double *speed_mm_min,
                          const double *new_speed_mm_min, uint32_t n, double tau_ms,
                          double *predicted_um)
{
    for (uint32_t i = 0; i < n; i++) {
        predicted_um[i] = radius_um[i] + delay_um(new_speed_mm_min[i] - speed_mm_min[i], tau_ms);
    }
}

double pretravel_time_increase(const double *speed_mm_min, const double *new_speed_mm_min,
                               uint32_t n)
{
    double before = 0.0;
    double after = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        before += 1.0 / speed_mm_min[i];
        after += 1.0 / new_speed_mm_min[i];
    }
    return after / before - 1.0;
}

double pretravel_time_s(const double *speed_mm_min, uint32_t n, double approach_mm)
{
    double time_min = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        time_min += approach_mm / speed_mm_min[i];
    }
    return S_PER_MIN * time_min;
}
