#include "cycle/kinematics_report.h"

#include <math.h>
#include <string.h>

#include "comp/kinematics_circle.h"

#define DEG_PER_RAD (180.0 / 3.14159265358979323846)

enum { SCATTER_BEFORE = 0, SCATTER_AFTER = 3, OFFSET = 6 }; /* places in q_mm */

static bool serves(const kinematics_station_t *station, uint8_t axis)
{
    return ((unsigned)station->serves >> axis & 1u) != 0u;
}

/* ---- scatter ---- */

typedef struct {
    double  square_sum;
    double  greatest;
    uint8_t count;
} errors_t;

static double error_mm(const kinematics_station_t *station, const double *expected_mm)
{
    double square = 0.0;
    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        double off = station->centre_mm[i] - expected_mm[i];
        square += off * off;
    }
    return sqrt(square);
}

static errors_t errors_of(const kinematics_plan_t *plan, const double (*expected_mm)[LINEAR_AXES],
                          uint8_t                  axis)
{
    errors_t errors = {0};
    for (uint8_t i = 0u; i < plan->measured; i++) {
        const kinematics_station_t *station = &plan->stations[i];
        if (serves(station, axis) && !station->is_reference && !station->is_second) {
            double error = error_mm(station, expected_mm[i]);
            errors.square_sum += error * error;
            errors.greatest = fmax(errors.greatest, error);
            errors.count++;
        }
    }
    return errors;
}

static double scatter_of(const errors_t *errors)
{
    return sqrt(errors->square_sum / errors->count);
}

/* ---- circle and backlash ---- */

static bool fit_circle(const kinematics_plan_t *plan, uint8_t axis, const double *direction,
                       kinematics_circle_t *circle)
{
    kinematics_point_t points[1 + KINEMATICS_POINTS_MAX];
    int32_t            count = 0;

    for (uint8_t i = 0u; i < plan->measured; i++) {
        const kinematics_station_t *station = &plan->stations[i];
        if (serves(station, axis) && !station->is_second) {
            memcpy(points[count].angle_deg, station->angle_deg, sizeof station->angle_deg);
            memcpy(points[count].position_mm, station->centre_mm, sizeof station->centre_mm);
            count++;
        }
    }
    return kinematics_circle_fit(direction, axis, points, count, circle) == KINEMATICS_OK;
}

/* By how much about `direction` `to` is ahead of `from`; small against a turn. */
static double ahead_deg(const kinematics_circle_t *circle, const double *n, const double *from,
                        const double *to)
{
    double along = 0.0;
    double radius[LINEAR_AXES];

    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        radius[i] = from[i] - circle->centre_mm[i];
    }
    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        uint8_t j = (uint8_t)((i + 1u) % LINEAR_AXES);
        uint8_t k = (uint8_t)((i + 2u) % LINEAR_AXES);
        along += (n[j] * radius[k] - n[k] * radius[j]) * (to[i] - from[i]);
    }
    return along / (circle->radius_mm * circle->radius_mm) * DEG_PER_RAD;
}

static void report_backlash(kinematics_axis_report_t *report, const kinematics_plan_t *plan,
                            uint8_t axis, const kinematics_circle_t *circle, const double *n)
{
    double  sum_deg = 0.0;
    uint8_t pairs = 0u;

    for (uint8_t i = 1u; i < plan->measured; i++) {
        const kinematics_station_t *second = &plan->stations[i];
        if (second->axis == axis && second->is_second) {
            double ahead = ahead_deg(circle, n, second[-1].centre_mm, second->centre_mm);
            sum_deg += second->approach < 0 ? ahead : -ahead;
            pairs++;
        }
    }
    report->has_backlash = pairs > 0u && circle->radius_mm >= KINEMATICS_CIRCLE_LEAST_MM;
    report->backlash_deg = report->has_backlash ? sum_deg / pairs : 0.0;
}

/* ---- report ---- */

static void report_axis(kinematics_axis_report_t *report, const kinematics_plan_t *plan,
                        const kinematics_expectation_t *expected, uint8_t axis)
{
    errors_t            before = errors_of(plan, expected->before_mm, axis);
    errors_t            after = errors_of(plan, expected->after_mm, axis);
    kinematics_circle_t circle;

    if (before.count == 0u) {
        return;
    }
    report->positions = before.count;
    report->scatter_before_mm = scatter_of(&before);
    report->scatter_after_mm = scatter_of(&after);
    report->greatest_before_mm = before.greatest;
    report->greatest_after_mm = after.greatest;
    if (fit_circle(plan, axis, expected->direction[axis], &circle)) {
        report->radius_mm = circle.radius_mm;
        report_backlash(report, plan, axis, &circle, expected->direction[axis]);
    }
}

void kinematics_report_make(kinematics_report_t *report, const kinematics_plan_t *plan,
                            const kinematics_expectation_t *expected)
{
    memset(report, 0, sizeof *report);
    for (uint8_t i = 0u; i < ROTARY_AXES; i++) {
        kinematics_axis_report_t *axis = &report->axes[i];
        report_axis(axis, plan, expected, i);
        bool is_measured = axis->positions > 0u;
        report->q_mm[SCATTER_BEFORE + i] =
            is_measured ? axis->scatter_before_mm : KINEMATICS_NOT_MEASURED;
        report->q_mm[SCATTER_AFTER + i] = is_measured && expected->is_optimised
                                              ? axis->scatter_after_mm
                                              : KINEMATICS_NOT_MEASURED;
        report->q_mm[OFFSET + i] = expected->offset_mm[i];
    }
}
