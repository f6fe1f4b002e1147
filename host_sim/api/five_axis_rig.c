#include "api/five_axis_rig.h"

#include <math.h>

#include "angle.h"
#include "api/batch.h"

#define UM_PER_MM           1000.0
#define LANE                9u
#define CALIBRATION_POINTS  36
#define CALIBRATION_TOUCHES (5 * CALIBRATION_POINTS)
#define CALIBRATION_MM      5.0
#define MOVE_S              1.0 /* between two touches; the rest of a second is random */
#define TURN_DEG_PER_S      60.0

/* Play a touch of a surface `approach_mm` ahead; gives the latched position past it in mm, or
 * NaN. */
static double play(five_axis_rig_t *rig, double approach_mm, double overtravel_mm,
                   const double in_probe[3])
{
    sim_outcome_t outcome;
    sim_touch_t  *touch = &rig->touch;

    ++touch->touch;
    touch->time_s = fmax(touch->time_s, (double)rig->rig.done_at / SIM_NS_PER_S) + MOVE_S +
                    sim_random_uniform(&rig->random, MOVE_S);
    touch->approach_mm = approach_mm;
    touch->alpha_deg = rig->is_tracking ? 0.0 : atan2(in_probe[1], in_probe[0]) / RAD_PER_DEG;
    touch->beta_deg = asin(fmax(-1.0, fmin(1.0, in_probe[2]))) / RAD_PER_DEG;
    rig->controller.overtravel_mm = overtravel_mm;
    rig->is_broken = rig->is_broken || rig_play(&rig->rig, touch, &outcome) != 0;
    if (rig->is_broken) {
        return NAN;
    }
    rig->error = outcome.error;
    rig->cycle_s = outcome.error == TOUCH_OK ? outcome.cycle_s : 0.0;
    return outcome.error == TOUCH_OK ? outcome.deviation_um / UM_PER_MM : (double)NAN;
}

/*
 * As on a ring gauge, 36 points in 5 runs: the mean way from contact to latch. What it is off by
 * stands in the height of every sphere.
 */
static void calibrate(five_axis_rig_t *rig)
{
    double sum_mm = 0.0;
    for (int i = 0; i < CALIBRATION_TOUCHES; ++i) {
        double angle = 2.0 * PI * i / CALIBRATION_POINTS;
        double in_probe[3] = {cos(angle), sin(angle), 0.0};
        sum_mm += play(rig, CALIBRATION_MM, CALIBRATION_MM, in_probe);
    }
    rig->calibrated_mm = sum_mm / CALIBRATION_TOUCHES;
}

int five_axis_check(const sim_machine_t *machine, const sim_machine_t *believed,
                    const sim_rig_t *setup)
{
    if (!sim_machine_is_sound(machine) || !sim_machine_is_sound(believed)) {
        return SIM_PLAY_ERR_MACHINE;
    }
    return sim_play_check(setup);
}

void five_axis_boot(five_axis_rig_t *rig, const sim_machine_t *machine, const sim_rig_t *setup,
                    five_axis_touching_t touching)
{
    *rig = (five_axis_rig_t){
        .machine = machine, .controller = *setup->controller, .is_tracking = touching.is_tracking};
    rig->touch = (sim_touch_t){.feed_mm_min = touching.feed_mm_min,
                               .sign = 1.0,
                               .temp_c = 20.0,
                               .path = touching.path,
                               .axis = SIM_AXIS_X};
    sim_machine_home(machine, &rig->stance);
    sim_random_begin(&rig->random, setup->seed, setup->replicate, UINT64_MAX, LANE);
    rig_boot(&rig->rig, setup->chain, &rig->controller, setup->settings, setup->settings_count,
             setup->seed, setup->replicate, 0);
    calibrate(rig);
}

void five_axis_turn(five_axis_rig_t *rig, int32_t axis, double command_deg)
{
    double from_deg = rig->stance.command_deg[axis];
    double sigma_deg = rig->machine->axes[axis].repeatability_deg;
    double scatter_deg = sigma_deg > 0.0 ? sim_random_normal(&rig->random, sigma_deg) : 0.0;
    sim_machine_turn(rig->machine, &rig->stance, axis, command_deg, scatter_deg);
    rig->touch.time_s += fabs(command_deg - from_deg) / TURN_DEG_PER_S;
}

/* A direction of the machine in the frame of the probe: what the head does, turned back. */
static void to_probe(const five_axis_rig_t *rig, const double direction[3], double in_probe[3])
{
    for (int i = 0; i < 3; ++i) {
        double unit[3] = {0.0, 0.0, 0.0};
        double seen[3];
        unit[i] = 1.0;
        sim_machine_probe_direction(rig->machine, &rig->stance, unit, seen);
        in_probe[i] = seen[0] * direction[0] + seen[1] * direction[1] + seen[2] * direction[2];
    }
}

/* Errors of a linear axis go with the axis that mostly moves, and its sense. */
static void name_axis(sim_touch_t *touch, const double start_mm[3], const double direction[3],
                      double approach_mm)
{
    int mostly = SIM_AXIS_X;
    for (int i = SIM_AXIS_Y; i <= SIM_AXIS_Z; ++i) {
        mostly = fabs(direction[i]) > fabs(direction[mostly]) + 1e-9 ? i : mostly;
    }
    touch->axis = mostly;
    touch->sign = direction[mostly] < 0.0 ? -1.0 : 1.0;
    touch->position_mm = start_mm[mostly] + direction[mostly] * approach_mm;
}

bool five_axis_touch(five_axis_rig_t *rig, const double start_mm[3], const double direction[3],
                     double travel_mm, double touched_mm[3])
{
    double in_probe[3];
    double approach_mm = sim_machine_distance_mm(rig->machine, &rig->stance, start_mm, direction);

    rig->error = TOUCH_ERR_NO_TOUCH;
    if (approach_mm <= 0.0) {
        rig->error = TOUCH_ERR_DEFLECTED_AT_START;
    }
    if (!(approach_mm > 0.0 && approach_mm < travel_mm)) { /* NaN as well */
        return false;
    }
    to_probe(rig, direction, in_probe);
    name_axis(&rig->touch, start_mm, direction, approach_mm);
    double past_mm = play(rig, approach_mm, travel_mm - approach_mm, in_probe);
    for (int i = 0; i < 3; ++i) {
        touched_mm[i] = start_mm[i] + direction[i] * (approach_mm + past_mm - rig->calibrated_mm);
    }
    return isfinite(past_mm);
}
