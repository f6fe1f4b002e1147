#include "gear_check.h"

#include <math.h>
#include <stdbool.h>

#include "angle.h"
#include "gear_output.h"

#define MOST_STAGES 4
#define STEEPEST    0.3 /* errors may change by that share of the way, or nothing converges */

static bool in_range(double value, double low, double high)
{
    return value >= low && value <= high; /* false for NaN */
}

static bool is_gear(const sim_gear_stage_t *stage, const sim_gear_t *gear)
{
    return in_range(gear->teeth, 1.0, 1e4) && in_range(stage->module_mm, 1e-3, 1e3);
}

static bool follows(const sim_gear_stage_t *stage, const sim_gear_t *gear)
{
    double steep_um = 2.0 * PI * (fabs(gear->eccentricity_um) + gear->teeth * fabs(gear->mesh_um)) +
                      8.0 * PI * gear->teeth * fabs(gear->pitch_rms_um);
    return steep_um <= STEEPEST * sim_gear_circumference_um(stage, gear);
}

static int check_stages(const sim_gear_train_t *train)
{
    if (train->stage_count < 0 || train->stage_count > MOST_STAGES) {
        return SIM_GEAR_ERR_STAGES;
    }
    for (int32_t i = 0; i < train->stage_count; ++i) {
        const sim_gear_stage_t *stage = &train->stages[i];
        if (!is_gear(stage, &stage->driver) || !is_gear(stage, &stage->driven) ||
            !in_range(stage->play_um, 0.0, 1e6)) {
            return SIM_GEAR_ERR_STAGES;
        }
        if (!follows(stage, &stage->driver) || !follows(stage, &stage->driven)) {
            return SIM_GEAR_ERR_ERRORS;
        }
    }
    return SIM_GEAR_OK;
}

static bool is_encoder(const sim_encoder_t *encoder)
{
    return in_range(encoder->lines, 1.0, 1e7) && in_range(encoder->radius_mm, 0.1, 1e5) &&
           in_range(encoder->jitter_ns, 0.0, 1e9) && in_range(encoder->mark, 0.0, 0.999) &&
           fabs(encoder->eccentricity_um) <= STEEPEST * encoder->radius_mm * GEAR_UM_PER_MM;
}

static bool is_motion(const sim_gear_train_t *train)
{
    return in_range(train->speed_rev_s, 1e-6, 1e6) && in_range(train->turns, 1e-6, 1e9) &&
           in_range(train->speed_ripple, 0.0, 0.9) &&
           (train->speed_ripple <= 0.0 || in_range(train->speed_ripple_hz, 1e-6, 1e6));
}

static bool follows_load(const sim_gear_train_t *train)
{
    double steep = fabs(train->load_ripple_nm * train->load_ripple_order);
    double thread_um = 2.0 * PI * fabs(train->screw_error_um);
    return (train->stiffness_nm_per_rad <= 0.0 ||
            steep <= STEEPEST * train->stiffness_nm_per_rad) &&
           (train->screw_lead_mm <= 0.0 ||
            thread_um <= STEEPEST * train->screw_lead_mm * GEAR_UM_PER_MM) &&
           fabs(train->screw_lead_error_ppm * GEAR_PPM) <= STEEPEST;
}

int sim_gear_check(const sim_gear_train_t *train)
{
    int code = check_stages(train);
    if (code != SIM_GEAR_OK) {
        return code;
    }
    if (!is_encoder(&train->input) || !is_encoder(&train->output) ||
        !in_range(train->clock_hz, 1.0, 1e10)) {
        return SIM_GEAR_ERR_ENCODER;
    }
    if (!is_motion(train)) {
        return SIM_GEAR_ERR_MOTION;
    }
    return follows_load(train) ? SIM_GEAR_OK : SIM_GEAR_ERR_ERRORS;
}

const char *sim_gear_error(int code)
{
    switch (code) {
    case SIM_GEAR_OK:
        return "no error";
    case SIM_GEAR_ERR_STAGES:
        return "gears: expected up to 4 stages, teeth from 1 and a module above 0";
    case SIM_GEAR_ERR_ENCODER:
        return "encoder: expected lines from 1, a radius above its eccentricity, marks below 1, "
               "a clock";
    case SIM_GEAR_ERR_MOTION:
        return "motion: expected speed and turns above 0, and a ripple of at most 0.9";
    default:
        return "errors so large that the output would not follow the input";
    }
}
