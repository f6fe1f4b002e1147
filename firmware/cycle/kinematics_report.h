/*
 * What the measurements of cycle 451 say of each rotary axis: scatter before and after the
 * optimisation, backlash, and with them the results Q141 to Q149.
 *
 * The errors of a station are measured minus expected, both relative to the reference of the axis.
 * Of positions that were approached from both sides the first approach counts, as it is that of the
 * reference; the second one is for the backlash alone.
 */
#ifndef CYCLE_KINEMATICS_REPORT_H
#define CYCLE_KINEMATICS_REPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/kinematics_plan.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KINEMATICS_RESULTS         9 /* Q141 to Q149 */
#define KINEMATICS_NOT_MEASURED    (-1.0)
#define KINEMATICS_CIRCLE_LEAST_MM 1.0 /* no backlash is computed from a smaller circle */

/* What the caller knows from the description of the machine, for each of the plan's `measured`
 * stations: */
typedef struct {
    /* where the sphere was expected, seen from the reference, with the kinematics as they were, */
    const double (*before_mm)[LINEAR_AXES];
    /* and with the optimised ones; */
    const double (*after_mm)[LINEAR_AXES];
    /* and how that place moves while the station's axis turns, in mm/rad. */
    const double (*slope_mm)[LINEAR_AXES];
    double offset_mm[LINEAR_AXES]; /* found for the machine's data: Q147 to Q149 */
    bool   is_optimised;           /* Q406 is not 0 */
} kinematics_expectation_t;

typedef struct {
    uint8_t positions;         /* besides the reference; 0: not measured, and the rest is 0 */
    double  radius_mm;         /* of the measured circle, mean */
    double  scatter_before_mm; /* root mean square of the errors in space; of one position that
                                  error */
    double scatter_after_mm;
    double greatest_before_mm; /* error in space */
    double greatest_after_mm;
    double positioning_deg;         /* optimised, relative to 0°: mean */
    double positioning_scatter_deg; /* standard deviation; 0 with one position */
    bool   has_backlash;            /* Q432 was not 0, and the circle is large enough */
    double backlash_deg;            /* mean: what the falling approach is ahead of the rising one */
} kinematics_axis_report_t;

typedef struct {
    kinematics_axis_report_t axes[ROTARY_AXES];
    double                   q_mm[KINEMATICS_RESULTS]; /* Q141 first */
} kinematics_report_t;

/* Report on all that the plan has measured. Task. */
void kinematics_report_make(kinematics_report_t *report, const kinematics_plan_t *plan,
                            const kinematics_expectation_t *expected);

#ifdef __cplusplus
}
#endif

#endif
