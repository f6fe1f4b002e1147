#include "api/five_axis_setup.h"

#include <math.h>
#include <stdlib.h>

#include "api/batch.h"
#include "api/five_axis_play.h"

/* ---- as the operator leaves it ---- */

/* The operator puts the tip above the preset. */
static void stand_above(sim_measure_kinematics_t *play)
{
    double up[3];
    double above_mm =
        play->truth.sphere_radius_mm + play->control.tip_radius_mm + play->control.start_above_mm;
    five_axis_tool_axis(&play->belief, play->control.start_deg, up);
    five_axis_ahead(play->preset_mm, up, above_mm, play->position_mm);
}

/* The operator turns the axes to where the program begins, sets the preset and puts the tip above
 * the sphere. */
static void prepare(sim_measure_kinematics_t *play)
{
    for (int32_t i = 0; i < SIM_ROTARIES; ++i) {
        five_axis_turn(&play->rig, i,
                       five_axis_encoder_deg(&play->belief, i, play->control.start_deg[i]));
        play->shown_deg[i] = play->control.start_deg[i];
    }
    five_axis_concentric(&play->truth, &play->rig.stance, play->preset_mm);
    five_axis_ahead(play->preset_mm, play->control.preset_miss_mm, 1.0, play->preset_mm);
    stand_above(play);
}

void sim_measure_kinematics_keep_preset(sim_measure_kinematics_t *play, const double sphere_mm[3])
{
    five_axis_expect(&play->belief, sphere_mm, play->control.start_deg, play->preset_mm);
    kinematics_settings_reset(&play->settings, KINEMATICS_COMPENSATE_PRESET);
    stand_above(play);
}

void sim_measure_kinematics_measure_grid(sim_measure_kinematics_t *play)
{
    kinematics_settings_reset(&play->settings, KINEMATICS_MEASURE_GRID);
}

/* What the firmware does not check itself; false for a NaN as well. */
static bool is_control(const sim_control_t *control)
{
    bool finite = true;
    for (int i = 0; i < 3; ++i) {
        finite = finite && isfinite(control->start_deg[i]) && isfinite(control->preset_miss_mm[i]);
    }
    return finite && control->start_above_mm >= 0.0 && isfinite(control->start_above_mm) &&
           control->touch_feed_mm_min > 0.0 && isfinite(control->touch_feed_mm_min) &&
           control->search_mm >= 0.0 && isfinite(control->search_mm) &&
           (control->path == SIM_PATH_SKIP || control->path == SIM_PATH_PLC);
}

int sim_measure_kinematics_open(const sim_rig_t *rig, const sim_machine_t *truth,
                                const sim_machine_t *believed, const sim_control_t *control,
                                sim_measure_kinematics_t **opened)
{
    sim_rig_t setup = *rig;
    int wrong = is_control(control) ? five_axis_check(truth, believed, rig) : SIM_PLAY_ERR_CONTROL;
    *opened = NULL;
    if (wrong != SIM_PLAY_OK) {
        return wrong;
    }
    sim_measure_kinematics_t *play = calloc(1u, sizeof *play);
    if (play == NULL) {
        return SIM_PLAY_ERR_MEMORY;
    }
    play->truth = *truth;
    play->chain = *rig->chain;
    setup.chain = &play->chain;
    play->control = *control;
    five_axis_believe(&play->belief, believed);
    kinematics_settings_reset(&play->settings, KINEMATICS_MEASURE);
    five_axis_boot(
        &play->rig, &play->truth, &setup,
        (five_axis_touching_t){control->touch_feed_mm_min, control->path, control->track != 0});
    prepare(play);
    *opened = play;
    return SIM_PLAY_OK;
}

void sim_measure_kinematics_close(sim_measure_kinematics_t *play)
{
    free(play);
}

void sim_measure_kinematics_believe(sim_measure_kinematics_t *play, const sim_machine_t *believed)
{
    five_axis_believe(&play->belief, believed);
}

/* ---- as the cycle is told ---- */

static bool is_in(const int32_t list[3], int32_t axis)
{
    return list[0] == axis || list[1] == axis || list[2] == axis;
}

static bool is_stacked(const sim_machine_t *machine)
{
    return machine->table[1] >= 0 || machine->head[1] >= 0;
}

kinematics_cycle_machine_t five_axis_described(const sim_measure_kinematics_t *play)
{
    const sim_control_t       *control = &play->control;
    kinematics_cycle_machine_t machine = {
        .tip_radius_mm = control->tip_radius_mm,
        .set_up_mm = control->set_up_mm,
        .probe_feed_max_mm_min = control->probe_feed_max_mm_min,
        .rapid_mm_min = control->rapid_mm_min,
        .tool_feed_mm_min = control->tool_feed_mm_min,
        .global_feed_mm_min = control->global_feed_mm_min,
        .global_clearance_mm = control->global_clearance_mm,
        .max_modification_mm = control->max_modification_mm,
        .max_dev_cal_ball_mm = control->max_dev_cal_ball_mm,
        .strobe_rot_ax_pos = control->strobe_rot_ax_pos,
        .has_kinematics_opt = control->has_kinematics_opt != 0,
        .has_kinematics_comp = control->has_kinematics_comp != 0,
        .has_advanced_functions_2 = control->has_advanced_functions_2 != 0,
        .is_tcpm_on = control->is_tcpm_on != 0,
        .is_turning = control->is_turning != 0,
        .is_stacked = is_stacked(&play->belief.machine),
        .grid = play->belief.grid,
    };
    five_axis_copy(machine.position_mm, play->position_mm);
    five_axis_copy(machine.preset_mm, play->preset_mm);
    five_axis_copy(machine.angle_deg, control->start_deg);
    five_axis_tool_axis(&play->belief, machine.angle_deg, machine.tool_axis);
    for (int32_t i = 0; i < SIM_ROTARIES; ++i) {
        machine.axes[i].is_present =
            is_in(play->belief.machine.table, i) || is_in(play->belief.machine.head, i);
        machine.axes[i].grid_deg = control->hirth_deg[i];
    }
    return machine;
}
