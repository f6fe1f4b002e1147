#include "api/five_axis_points.h"

#include <math.h>
#include <stdbool.h>

#include "api/batch.h"
#include "api/five_axis_belief.h"
#include "api/five_axis_rig.h"
#include "cycle/sphere_probe.h"

/* All touches of one sphere; false when one failed, or no sphere fits. */
static bool probe_sphere(five_axis_rig_t *rig, const sphere_probe_config_t *config,
                         double travel_mm, sim_sphere_t *sphere)
{
    sphere_probe_t      probe;
    sphere_probe_step_t step;
    double              touched_mm[3];

    sphere_probe_start(&probe, config);
    while (sphere_probe_next(&probe, &step)) {
        if (!step.is_touch) {
            continue;
        }
        if (!five_axis_touch(rig, step.target_mm, step.direction, travel_mm, touched_mm)) {
            return false;
        }
        sphere_probe_touched(&probe, touched_mm);
    }
    return sphere_probe_solve(&probe, sphere->centre_mm, &sphere->contact_mm);
}

static void turn_to(five_axis_rig_t *rig, const five_axis_belief_t *belief,
                    const double angle_deg[3])
{
    for (int32_t axis = 0; axis < SIM_ROTARIES; ++axis) {
        five_axis_turn(rig, axis, five_axis_encoder_deg(belief, axis, angle_deg[axis]));
    }
}

/* False for a NaN as well. */
static bool is_probing(const sim_probing_t *probing)
{
    return probing->feed_mm_min > 0.0 && isfinite(probing->feed_mm_min) &&
           probing->stand_off_mm > 0.0 && isfinite(probing->stand_off_mm) &&
           probing->search_mm >= 0.0 && isfinite(probing->search_mm) &&
           isfinite(probing->reference_deg) && probing->touches >= SPHERE_TOUCHES_MIN &&
           probing->touches <= SPHERE_TOUCHES_MAX &&
           (probing->path == SIM_PATH_SKIP || probing->path == SIM_PATH_PLC);
}

static int check(const sim_rig_t *rig, const sim_machine_t *truth, const sim_machine_t *believed,
                 const sim_probing_t *probing, const sim_sphere_t *spheres, uint32_t n)
{
    bool good = is_probing(probing);
    for (uint32_t i = 0; i < n; ++i) {
        const double *at = spheres[i].angle_deg;
        good = good && isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]);
    }
    return good ? five_axis_check(truth, believed, rig) : SIM_PLAY_ERR_CONTROL;
}

int32_t sim_five_axis_points(const sim_rig_t *rig, const sim_machine_t *truth,
                             const sim_machine_t *believed, const sim_probing_t *probing,
                             sim_sphere_t *spheres, uint32_t n)
{
    five_axis_rig_t       played;
    five_axis_belief_t    belief;
    sphere_probe_config_t config = {
        .contact_mm = truth->sphere_radius_mm + truth->tip_radius_mm,
        .stand_off_mm = probing->stand_off_mm,
        .reference_deg = probing->reference_deg,
        .touches = (uint8_t)probing->touches,
    };
    int wrong = check(rig, truth, believed, probing, spheres, n);
    if (wrong != SIM_PLAY_OK) {
        return wrong;
    }
    five_axis_believe(&belief, believed);
    five_axis_boot(&played, truth, rig,
                   (five_axis_touching_t){probing->feed_mm_min, probing->path, false});
    for (uint32_t i = 0; i < n; ++i) {
        turn_to(&played, &belief, spheres[i].angle_deg);
        if (i == 0u) { /* the operator has found it */
            five_axis_concentric(truth, &played.stance, config.centre_mm);
        } else {
            double sphere_mm[3];
            five_axis_turn_back(&belief, spheres[i - 1u].angle_deg, spheres[i - 1u].centre_mm,
                                sphere_mm);
            five_axis_expect(&belief, sphere_mm, spheres[i].angle_deg, config.centre_mm);
        }
        five_axis_tool_axis(&belief, spheres[i].angle_deg, config.tool_axis);
        if (!probe_sphere(&played, &config, probing->stand_off_mm + probing->search_mm,
                          &spheres[i])) {
            return (int32_t)i;
        }
    }
    return (int32_t)n;
}
