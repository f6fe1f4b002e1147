/* What the controller believes of a five-axis machine, and what it expects by that. */
#ifndef API_FIVE_AXIS_BELIEF_H
#define API_FIVE_AXIS_BELIEF_H

#include "comp/kinematics.h"
#include "comp/kinematics_grid.h"
#include "five_axis.h"

typedef struct {
    sim_machine_t        machine; /* without any error */
    kinematics_machine_t chain;   /* the same in the firmware's terms */
    kinematics_grid_t    grid;    /* of cycle 453; no nodes: none */
} five_axis_belief_t;

/* Believe the axes of `machine`, and that they have no error. */
void five_axis_believe(five_axis_belief_t *belief, const sim_machine_t *machine);

/* Where the linear axes should read the centre of a sphere that stands at `sphere_mm` at zero. */
void five_axis_expect(const five_axis_belief_t *belief, const double sphere_mm[3],
                      const double angle_deg[3], double reading_mm[3]);

/* What the table of cycle 453 has at these angles; nothing where there is no sound grid. */
void five_axis_compensation(const five_axis_belief_t *belief, const double angle_deg[3],
                            double offset_mm[3]);

/* Where it stands at zero, by where it was read. */
void five_axis_turn_back(const five_axis_belief_t *belief, const double angle_deg[3],
                         const double reading_mm[3], double sphere_mm[3]);

/* Where the encoder of an axis goes when the control shows `shown_deg`, by its datum. */
double five_axis_encoder_deg(const five_axis_belief_t *belief, int32_t axis, double shown_deg);

/* From the tip to the spindle. */
void five_axis_tool_axis(const five_axis_belief_t *belief, const double angle_deg[3],
                         double axis[3]);

/* Where the linear axes of a machine really read when the tip is in the sphere's centre. */
void five_axis_concentric(const sim_machine_t *machine, const sim_stance_t *stance,
                          double reading_mm[3]);

#endif
