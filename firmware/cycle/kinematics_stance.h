/*
 * Where the rotary axes stand during cycle 451 and from which side they came there, and which of
 * them turns next on the way to a station: A first, then B, then C, one alone at a time. An axis
 * with a side in the plan passes that far before its angle and comes on from there, its measured
 * backlash taken up, also while another axis is measured. Any context.
 */
#ifndef CYCLE_KINEMATICS_STANCE_H
#define CYCLE_KINEMATICS_STANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "cycle/kinematics_plan.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    double angle_deg[ROTARY_AXES];
    double side_deg[ROTARY_AXES]; /* by which it came, as in the plan; 0: as it came */
} kinematics_stance_t;

/* Whether all axes stand at the plan's next station as that wants it. */
bool kinematics_stance_is_at(const kinematics_stance_t *stance, const kinematics_plan_t *plan);

/* Turn the next axis on the way there: which one, or false when none is left. */
bool kinematics_stance_turn(kinematics_stance_t *stance, const kinematics_plan_t *plan,
                            uint8_t *axis);

#ifdef __cplusplus
}
#endif

#endif
