#include "api/kinematics_results.h"

#include <string.h>

#include "api/five_axis_station.h"
#include "cycle/kinematics_report.h"

static sim_axis_result_t result_of(const kinematics_axis_report_t *axis)
{
    return (sim_axis_result_t){
        .positions = axis->positions,
        .has_backlash = axis->has_backlash,
        .radius_mm = axis->radius_mm,
        .scatter_before_mm = axis->scatter_before_mm,
        .scatter_after_mm = axis->scatter_after_mm,
        .greatest_before_mm = axis->greatest_before_mm,
        .greatest_after_mm = axis->greatest_after_mm,
        .positioning_deg = axis->positioning_deg,
        .positioning_scatter_deg = axis->positioning_scatter_deg,
        .backlash_deg = axis->backlash_deg,
    };
}

int sim_measure_kinematics_results(const sim_station_t *stations, uint32_t n,
                                   const sim_expectation_t *expected, sim_axis_result_t axes[3],
                                   double q_mm[9])
{
    kinematics_plan_t        plan = {.count = 0u};
    kinematics_report_t      report;
    kinematics_expectation_t seen = {
        .before_mm = expected->before_mm,
        .after_mm = expected->after_mm,
        .slope_mm = expected->slope_mm,
        .is_optimised = expected->is_optimised != 0,
    };

    if (n > KINEMATICS_STATIONS_MAX) {
        return -1;
    }
    for (uint32_t i = 0u; i < n; i++) {
        plan.stations[i] = five_axis_station(&stations[i]);
    }
    plan.count = plan.measured = (uint8_t)n;
    memcpy(seen.offset_mm, expected->offset_mm, sizeof seen.offset_mm);
    kinematics_report_make(&report, &plan, &seen);
    for (int i = 0; i < ROTARY_AXES; i++) {
        axes[i] = result_of(&report.axes[i]);
    }
    memcpy(q_mm, report.q_mm, sizeof report.q_mm);
    return 0;
}
