#include "gear_output.h"

#include <math.h>

#include "angle.h"
#include "random.h"

/* Whole turns are left out first: thousands of them would cost digits. */
double sim_gear_sine(double turns, double phase_deg)
{
    return sim_wave(turns - floor(turns), phase_deg);
}

/* ---- gears: ways along the pitch circle ------------------------------------------------------ */

static double drawn_pitch_um(const sim_gear_t *gear, uint64_t seed, uint32_t serial, double tooth)
{
    sim_random_t random;
    double       on_gear = tooth - floor(tooth / gear->teeth) * gear->teeth;
    sim_random_begin(&random, seed, serial, (uint64_t)on_gear, GEAR_LANE_PITCH);
    return sim_random_normal(&random, gear->pitch_rms_um);
}

/* One tooth hands over to the next smoothly: two share the load for a while. */
static double pitch_um(const sim_gear_t *gear, uint64_t seed, uint32_t serial, double turns)
{
    if (gear->pitch_rms_um <= 0.0) {
        return 0.0;
    }
    double place = turns * gear->teeth;
    double tooth = floor(place);
    double share = 0.5 - 0.5 * cos(PI * (place - tooth));
    return (1.0 - share) * drawn_pitch_um(gear, seed, serial, tooth) +
           share * drawn_pitch_um(gear, seed, serial, tooth + 1.0);
}

/* By how far the flank in contact is ahead of that of a perfect gear. */
static double flank_um(const sim_gear_t *gear, uint64_t seed, uint32_t serial, double turns)
{
    return gear->eccentricity_um * sim_gear_sine(turns, gear->eccentricity_phase_deg) +
           gear->mesh_um * sim_gear_sine(turns * gear->teeth, gear->mesh_phase_deg) +
           pitch_um(gear, seed, serial, turns);
}

double sim_gear_circumference_um(const sim_gear_stage_t *stage, const sim_gear_t *gear)
{
    return PI * stage->module_mm * GEAR_UM_PER_MM * gear->teeth;
}

/* The flanks touch: the way of the driver's is that of the driven one's. */
static double driven_turns(const sim_gear_stage_t *stage, uint64_t seed, uint32_t serial,
                           double driver_turns)
{
    double way_um = driver_turns * sim_gear_circumference_um(stage, &stage->driver) +
                    flank_um(&stage->driver, seed, serial, driver_turns);
    double around_um = sim_gear_circumference_um(stage, &stage->driven);
    double turns = way_um / around_um;
    for (int round = 0; round < GEAR_ROUNDS; ++round) {
        double before = turns;
        turns = (way_um - flank_um(&stage->driven, seed, serial + 1u, turns)) / around_um;
        if (fabs(turns - before) <= GEAR_CLOSE * (1.0 + fabs(turns))) {
            break;
        }
    }
    return turns;
}

/* ---- the train ------------------------------------------------------------------------------- */

static double twisted(const sim_gear_run_t *run, double turns)
{
    const sim_gear_train_t *train = &run->train;
    if (train->stiffness_nm_per_rad <= 0.0) {
        return turns;
    }
    double ripple_nm = train->load_ripple_nm * sim_gear_sine(turns * train->load_ripple_order, 0.0);
    double twist_rad = (train->load_nm * run->sense + ripple_nm) / train->stiffness_nm_per_rad;
    return turns - twist_rad / (2.0 * PI);
}

/* Travel of the nut in leads, which a scale measures. */
static double screwed(const sim_gear_train_t *train, double turns)
{
    if (train->screw_lead_mm <= 0.0) {
        return turns;
    }
    double thread_um = train->screw_error_um * sim_gear_sine(turns, train->screw_error_phase_deg);
    return turns * (1.0 + train->screw_lead_error_ppm * GEAR_PPM) +
           thread_um / (train->screw_lead_mm * GEAR_UM_PER_MM);
}

double sim_gear_output_turns(const sim_gear_run_t *run, double driving_turns)
{
    const sim_gear_train_t *train = &run->train;
    double                  turns = driving_turns;
    for (int32_t i = 0; i < train->stage_count; ++i) {
        turns = driven_turns(&train->stages[i], train->seed, 2u * (uint32_t)i, turns);
    }
    return screwed(train, twisted(run, turns));
}
