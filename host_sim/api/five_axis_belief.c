#include "api/five_axis_belief.h"

#include "comp/kinematics_chain.h"

#define PASSES 4 /* linear axes are only a little long or askew */

static void copy(double to[3], const double from[3])
{
    for (int i = 0; i < 3; ++i) {
        to[i] = from[i];
    }
}

/* The axes of one list, behind those that are there already. */
static void list_axes(const sim_machine_t *machine, const int32_t list[3], int32_t is_head,
                      kinematics_machine_t *chain)
{
    for (int i = 0; i < SIM_ROTARIES && list[i] >= 0 && chain->axes_count < KINEMATICS_AXES_MAX;
         ++i) {
        kinematics_axis_t *axis = &chain->axes[chain->axes_count];
        ++chain->axes_count;
        axis->letter = 'A' + list[i];
        axis->is_head = is_head;
        copy(axis->direction, machine->axes[list[i]].direction);
        copy(axis->point_mm, machine->axes[list[i]].point_mm);
    }
}

static kinematics_grid_t grid_of(const sim_grid_t *given)
{
    kinematics_grid_t grid = {{0u}, {{0.0}}};
    for (int axis = 0; axis < SIM_ROTARIES; ++axis) {
        grid.count[axis] = (uint8_t)given->count[axis];
        for (int32_t i = 0; i < given->count[axis]; ++i) {
            grid.node_deg[axis][i] = given->node_deg[axis][i];
        }
    }
    return grid;
}

void five_axis_believe(five_axis_belief_t *belief, const sim_machine_t *machine)
{
    *belief = (five_axis_belief_t){.machine = *machine};
    for (int i = 0; i < SIM_ROTARIES; ++i) {
        sim_rotary_t plain = {.datum_deg = machine->axes[i].datum_deg};
        copy(plain.direction, machine->axes[i].direction);
        copy(plain.point_mm, machine->axes[i].point_mm);
        belief->machine.axes[i] = plain;
    }
    for (int i = 0; i < 3; ++i) {
        belief->machine.scale_ppm[i] = 0.0;
        belief->machine.square_rad[i] = 0.0;
        belief->machine.tip_error_mm[i] = 0.0;
    }
    belief->grid = grid_of(&machine->grid);
    list_axes(machine, machine->table, 0, &belief->chain);
    list_axes(machine, machine->head, 1, &belief->chain);
}

void five_axis_compensation(const five_axis_belief_t *belief, const double angle_deg[3],
                            double offset_mm[3])
{
    for (int i = 0; i < 3; ++i) {
        offset_mm[i] = 0.0;
    }
    if (kinematics_grid_is_sound(&belief->grid)) {
        kinematics_grid_interpolate(&belief->grid, belief->machine.grid.offset_mm[0], angle_deg,
                                    offset_mm);
    }
}

void five_axis_expect(const five_axis_belief_t *belief, const double sphere_mm[3],
                      const double angle_deg[3], double reading_mm[3])
{
    double unknowns[KINEMATICS_UNKNOWNS_MAX] = {0.0};
    for (int i = 0; i < 3; ++i) {
        unknowns[i] = sphere_mm[i];
        unknowns[3 + i] = belief->machine.tool_mm[i] + belief->machine.tip_mm[i];
    }
    double angles_deg[KINEMATICS_AXES_MAX] = {0.0, 0.0, 0.0};
    for (int32_t i = 0; i < belief->chain.axes_count; ++i) {
        angles_deg[i] = angle_deg[belief->chain.axes[i].letter - 'A'];
    }
    double offset_mm[3];
    kinematics_chain_position(&belief->chain, unknowns, angles_deg, reading_mm);
    five_axis_compensation(belief, angle_deg, offset_mm);
    for (int i = 0; i < 3; ++i) {
        reading_mm[i] += offset_mm[i] - belief->machine.tip_mm[i];
    }
}

/*
 * A turn is a rigid motion of the sphere, so the images of the origin and of the unit vectors turn
 * it back.
 */
void five_axis_turn_back(const five_axis_belief_t *belief, const double angle_deg[3],
                         const double reading_mm[3], double sphere_mm[3])
{
    double       origin_mm[3];
    const double zero[3] = {0.0, 0.0, 0.0};
    five_axis_expect(belief, zero, angle_deg, origin_mm);
    for (int axis = 0; axis < 3; ++axis) {
        double image_mm[3];
        double unit[3] = {0.0, 0.0, 0.0};
        unit[axis] = 1.0;
        five_axis_expect(belief, unit, angle_deg, image_mm);
        sphere_mm[axis] = 0.0;
        for (int i = 0; i < 3; ++i) {
            sphere_mm[axis] += (image_mm[i] - origin_mm[i]) * (reading_mm[i] - origin_mm[i]);
        }
    }
}

double five_axis_encoder_deg(const five_axis_belief_t *belief, int32_t axis, double shown_deg)
{
    return shown_deg - belief->machine.axes[axis].datum_deg;
}

void five_axis_tool_axis(const five_axis_belief_t *belief, const double angle_deg[3],
                         double axis[3])
{
    const double up[3] = {0.0, 0.0, 1.0};
    sim_stance_t stance;
    sim_machine_home(&belief->machine, &stance);
    for (int i = 0; i < SIM_ROTARIES; ++i) {
        sim_machine_turn(&belief->machine, &stance, i, angle_deg[i], 0.0);
    }
    sim_machine_probe_direction(&belief->machine, &stance, up, axis);
}

void five_axis_concentric(const sim_machine_t *machine, const sim_stance_t *stance,
                          double reading_mm[3])
{
    double centre_mm[3];
    double tip_mm[3];
    sim_machine_sphere(machine, stance, centre_mm);
    copy(reading_mm, centre_mm);
    for (int pass = 0; pass < PASSES; ++pass) {
        sim_machine_tip(machine, stance, reading_mm, tip_mm);
        for (int i = 0; i < 3; ++i) {
            reading_mm[i] += centre_mm[i] - tip_mm[i];
        }
    }
}
