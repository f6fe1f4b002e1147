#include "cycle/kinematics_report.h"

#include <math.h>
#include <string.h>

#define DEG_PER_RAD (180.0 / 3.14159265358979323846)

enum { SCATTER_BEFORE = 0, SCATTER_AFTER = 3, OFFSET = 6 }; /* places in q_mm */

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const double *a, const double *b, double *difference)
{
    for (uint8_t i = 0u; i < LINEAR_AXES; i++) {
        difference[i] = a[i] - b[i];
    }
}

/* The angle of a small motion along `slope_mm`; 0 where the sphere stands in the axis. */
static double angle_deg(const double *motion_mm, const double *slope_mm)
{
    double square = dot(slope_mm, slope_mm);
    return square > 0.0 ? dot(motion_mm, slope_mm) / square * DEG_PER_RAD : 0.0;
}

/* Sums over the positions of one axis. */
typedef struct {
    double  square_before;
    double  square_after;
    double  radius;
    double  angle;
    double  square_angle;
    double  backlash;
    uint8_t pairs;
} sums_t;

static void add_position(sums_t *sums, kinematics_axis_report_t *report, const double *centre_mm,
                         const kinematics_expectation_t *expected, uint8_t index)
{
    double before[LINEAR_AXES];
    double after[LINEAR_AXES];

    subtract(centre_mm, expected->before_mm[index], before);
    subtract(centre_mm, expected->after_mm[index], after);
    double angle = angle_deg(after, expected->slope_mm[index]);
    sums->square_before += dot(before, before);
    sums->square_after += dot(after, after);
    sums->radius += sqrt(dot(expected->slope_mm[index], expected->slope_mm[index]));
    sums->angle += angle;
    sums->square_angle += angle * angle;
    report->greatest_before_mm = fmax(report->greatest_before_mm, sqrt(dot(before, before)));
    report->greatest_after_mm = fmax(report->greatest_after_mm, sqrt(dot(after, after)));
    report->positions++;
}

static void add_pair(sums_t *sums, const kinematics_station_t *first,
                     const kinematics_station_t *second, const double *slope_mm)
{
    double moved[LINEAR_AXES];

    subtract(second->centre_mm, first->centre_mm, moved);
    double ahead = angle_deg(moved, slope_mm);
    sums->backlash += second->approach < 0 ? ahead : -ahead;
    sums->pairs++;
}

static void conclude(kinematics_axis_report_t *report, const sums_t *sums)
{
    double n = report->positions;
    double spread = sums->square_angle - sums->angle * sums->angle / n;

    report->radius_mm = sums->radius / n;
    report->scatter_before_mm = sqrt(sums->square_before / n);
    report->scatter_after_mm = sqrt(sums->square_after / n);
    report->positioning_deg = sums->angle / n;
    report->positioning_scatter_deg = n > 1.0 ? sqrt(fmax(spread, 0.0) / (n - 1.0)) : 0.0;
    report->has_backlash = sums->pairs > 0u && report->radius_mm >= KINEMATICS_CIRCLE_LEAST_MM;
    report->backlash_deg = report->has_backlash ? sums->backlash / sums->pairs : 0.0;
}

static void report_axis(kinematics_axis_report_t *report, const kinematics_plan_t *plan,
                        const kinematics_expectation_t *expected, uint8_t axis)
{
    sums_t sums = {0};

    for (uint8_t i = 0u; i < plan->measured; i++) {
        const kinematics_station_t *station = &plan->stations[i];
        if (station->axis != axis || station->is_reference) {
            continue;
        }
        if (station->is_second && i > 0u) {
            add_pair(&sums, &plan->stations[i - 1u], station, expected->slope_mm[i]);
        } else {
            add_position(&sums, report, station->centre_mm, expected, i);
        }
    }
    if (report->positions > 0u) {
        conclude(report, &sums);
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
