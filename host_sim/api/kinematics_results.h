/*
 * firmware/cycle/kinematics_report for users of the shared library. Python reads this header too:
 * no more of the preprocessor than what can be left out.
 */
#ifndef API_KINEMATICS_RESULTS_H
#define API_KINEMATICS_RESULTS_H

#include <stdint.h>

#include "api/five_axis_cycle.h"

#pragma GCC visibility push(default)

/* See kinematics_axis_report_t. */
typedef struct {
    int32_t positions;
    int32_t has_backlash;
    double  radius_mm;
    double  scatter_before_mm;
    double  scatter_after_mm;
    double  greatest_before_mm;
    double  greatest_after_mm;
    double  positioning_deg;
    double  positioning_scatter_deg;
    double  backlash_deg;
} sim_axis_result_t;

/* See kinematics_expectation_t; the arrays are [station][X, Y, Z]. */
typedef struct {
    const double (*before_mm)[3];
    const double (*after_mm)[3];
    const double (*slope_mm)[3];
    double  offset_mm[3];
    int32_t is_optimised;
} sim_expectation_t;

/*
 * Report on `n` stations, in the order in which they were measured, at most as many as a cycle has:
 * axes A, B, C and Q141 to Q149. Returns 0, or -1 for too many stations.
 */
int sim_measure_kinematics_results(const sim_station_t *stations, uint32_t n,
                                   const sim_expectation_t *expected, sim_axis_result_t axes[3],
                                   double q_mm[9]);

#pragma GCC visibility pop

#endif
