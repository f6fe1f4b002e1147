#include "five_axis.h"

#include <math.h>
#include <stdbool.h>

#include "angle.h"

#define PPM            1.0e-6
#define UNIT_TOLERANCE 1.0e-4

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool are_finite(const double *values, int n)
{
    bool finite = true;
    for (int i = 0; i < n; ++i) {
        finite = finite && isfinite(values[i]);
    }
    return finite;
}

static bool is_rotary(const sim_rotary_t *axis)
{
    const double plain[] = {axis->datum_deg,        axis->zero_deg,       axis->backlash_deg,
                            axis->once_deg,         axis->once_phase_deg, axis->twice_deg,
                            axis->twice_phase_deg,  axis->radial_mm,      axis->axial_mm,
                            axis->repeatability_deg};
    return are_finite(plain, sizeof plain / sizeof *plain) && are_finite(axis->point_mm, 3) &&
           are_finite(axis->offset_mm, 3) && are_finite(axis->tilt_rad, 3) &&
           fabs(sqrt(dot(axis->direction, axis->direction)) - 1.0) <= UNIT_TOLERANCE &&
           axis->backlash_deg >= 0.0 && axis->repeatability_deg >= 0.0;
}

/* Counts how often the lists name each axis; false for one that there is not. */
static bool count_axes(const int32_t list[3], int32_t counts[3])
{
    bool good = true;
    for (int i = 0; i < SIM_ROTARIES; ++i) {
        good = good && list[i] >= -1 && list[i] < SIM_ROTARIES;
        if (good && list[i] >= 0) {
            ++counts[list[i]];
        }
    }
    return good;
}

/* As many nodes as there is room for; where they stand is the cycle's affair. */
static bool is_grid(const sim_grid_t *grid)
{
    bool good = are_finite(grid->node_deg[0], sizeof grid->node_deg / sizeof(double)) &&
                are_finite(grid->offset_mm[0], sizeof grid->offset_mm / sizeof(double));
    for (int i = 0; i < SIM_ROTARIES; ++i) {
        good = good && grid->count[i] >= 0 &&
               grid->count[i] <= (int32_t)(sizeof grid->node_deg[0] / sizeof(double));
    }
    return good;
}

int32_t sim_machine_is_sound(const sim_machine_t *machine)
{
    int32_t counts[3] = {0, 0, 0};
    bool    good = count_axes(machine->table, counts) && count_axes(machine->head, counts);
    for (int i = 0; i < SIM_ROTARIES; ++i) {
        good = good && counts[i] <= 1 && is_rotary(&machine->axes[i]);
    }
    return good && counts[0] + counts[1] + counts[2] > 0 && are_finite(machine->tool_mm, 3) &&
           are_finite(machine->tip_mm, 3) && are_finite(machine->tip_error_mm, 3) &&
           is_grid(&machine->grid) && are_finite(machine->sphere_mm, 3) &&
           are_finite(machine->scale_ppm, 3) && are_finite(machine->square_rad, 3) &&
           isfinite(machine->sphere_radius_mm) && machine->sphere_radius_mm > 0.0 &&
           isfinite(machine->tip_radius_mm) && machine->tip_radius_mm >= 0.0;
}

/* Turn `v` by a unit quaternion (w, x, y, z). */
static void turn(const double q[4], double v[3])
{
    const double t[3] = {
        2.0 * (q[2] * v[2] - q[3] * v[1]),
        2.0 * (q[3] * v[0] - q[1] * v[2]),
        2.0 * (q[1] * v[1] - q[2] * v[0]),
    };
    const double turned[3] = {
        v[0] + q[0] * t[0] + q[2] * t[2] - q[3] * t[1],
        v[1] + q[0] * t[1] + q[3] * t[0] - q[1] * t[2],
        v[2] + q[0] * t[2] + q[1] * t[1] - q[2] * t[0],
    };
    for (int i = 0; i < 3; ++i) {
        v[i] = turned[i];
    }
}

static void turn_about(const double axis[3], double rad, double v[3])
{
    double s = sin(0.5 * rad);
    double q[4] = {cos(0.5 * rad), s * axis[0], s * axis[1], s * axis[2]};
    turn(q, v);
}

/* A direction across `axis`, and the one that completes the right-handed three. */
static void across(const double axis[3], double u[3], double v[3])
{
    bool   is_x = fabs(axis[0]) > 0.9;
    double other[3] = {is_x ? 0.0 : 1.0, is_x ? 1.0 : 0.0, 0.0};
    double along = dot(other, axis);
    double length = sqrt(1.0 - along * along);
    for (int i = 0; i < 3; ++i) {
        u[i] = (other[i] - along * axis[i]) / length;
    }
    v[0] = axis[1] * u[2] - axis[2] * u[1];
    v[1] = axis[2] * u[0] - axis[0] * u[2];
    v[2] = axis[0] * u[1] - axis[1] * u[0];
}

/* The line of an axis as it is at this angle: location errors, and what it does as it turns. */
static void true_line(const sim_rotary_t *axis, double load_rad, double direction[3],
                      double point_mm[3])
{
    double u[3];
    double v[3];
    for (int i = 0; i < 3; ++i) {
        direction[i] = axis->direction[i];
    }
    for (int i = 0; i < 3; ++i) {
        double unit[3] = {0.0, 0.0, 0.0};
        unit[i] = 1.0;
        turn_about(unit, axis->tilt_rad[i], direction);
    }
    across(direction, u, v);
    for (int i = 0; i < 3; ++i) {
        point_mm[i] = axis->point_mm[i] + axis->offset_mm[i] +
                      axis->radial_mm * (cos(2.0 * load_rad) * u[i] + sin(2.0 * load_rad) * v[i]);
    }
}

/* Carry a point by the turn of one axis, or only turn a direction. */
static void carry(const sim_rotary_t *axis, double load_deg, bool is_point, double v[3])
{
    double direction[3];
    double point_mm[3];
    double load_rad = load_deg * RAD_PER_DEG;
    true_line(axis, load_rad, direction, point_mm);
    for (int i = 0; i < 3; ++i) {
        v[i] -= is_point ? point_mm[i] : 0.0;
    }
    turn_about(direction, load_rad, v);
    double axial_mm = is_point ? axis->axial_mm * sin(load_rad) : 0.0;
    for (int i = 0; i < 3; ++i) {
        v[i] += is_point ? point_mm[i] + axial_mm * direction[i] : 0.0;
    }
}

/* The last of a list carries first, and its carriers carry it. */
static void carry_all(const sim_machine_t *machine, const int32_t list[3],
                      const sim_stance_t *stance, bool is_point, double v[3])
{
    for (int i = 2; i >= 0; --i) {
        if (list[i] >= 0) {
            carry(&machine->axes[list[i]], stance->load_deg[list[i]], is_point, v);
        }
    }
}

/* Where the load is when it was pushed in the positive sense to what the encoder calls so. */
static double load_deg(const sim_rotary_t *axis, double pushed_deg)
{
    double rad = pushed_deg * RAD_PER_DEG;
    return pushed_deg + axis->zero_deg +
           axis->once_deg * sin(rad + axis->once_phase_deg * RAD_PER_DEG) +
           axis->twice_deg * sin(2.0 * rad + axis->twice_phase_deg * RAD_PER_DEG);
}

void sim_machine_home(const sim_machine_t *machine, sim_stance_t *stance)
{
    for (int i = 0; i < SIM_ROTARIES; ++i) {
        stance->command_deg[i] = 0.0;
        stance->pushed_deg[i] = 0.0;
        stance->load_deg[i] = load_deg(&machine->axes[i], 0.0);
    }
}

void sim_machine_turn(const sim_machine_t *machine, sim_stance_t *stance, int32_t axis,
                      double command_deg, double scatter_deg)
{
    const sim_rotary_t *rotary = &machine->axes[axis];
    double              ahead_deg = command_deg + scatter_deg;
    double              pushed_deg = fmax(stance->pushed_deg[axis], ahead_deg);

    pushed_deg = fmin(pushed_deg, ahead_deg + rotary->backlash_deg);
    stance->command_deg[axis] = command_deg;
    stance->pushed_deg[axis] = pushed_deg;
    stance->load_deg[axis] = load_deg(rotary, pushed_deg);
}

void sim_machine_sphere(const sim_machine_t *machine, const sim_stance_t *stance,
                        double centre_mm[3])
{
    for (int i = 0; i < 3; ++i) {
        centre_mm[i] = machine->sphere_mm[i];
    }
    carry_all(machine, machine->table, stance, true, centre_mm);
}

/* What a reading, or a way, of the linear axes really is. */
static void stretch(const sim_machine_t *machine, const double reading_mm[3], double real_mm[3])
{
    double way[3];
    for (int i = 0; i < 3; ++i) {
        way[i] = reading_mm[i] * (1.0 + machine->scale_ppm[i] * PPM);
    }
    real_mm[0] = way[0] + machine->square_rad[0] * way[1] + machine->square_rad[1] * way[2];
    real_mm[1] = way[1] + machine->square_rad[2] * way[2];
    real_mm[2] = way[2];
}

void sim_machine_tip(const sim_machine_t *machine, const sim_stance_t *stance,
                     const double reading_mm[3], double tip_mm[3])
{
    double from_ram_mm[3];
    for (int i = 0; i < 3; ++i) {
        from_ram_mm[i] = machine->tool_mm[i] + machine->tip_mm[i] + machine->tip_error_mm[i];
    }
    carry_all(machine, machine->head, stance, true, from_ram_mm);
    stretch(machine, reading_mm, tip_mm);
    for (int i = 0; i < 3; ++i) {
        tip_mm[i] += from_ram_mm[i] - machine->tool_mm[i];
    }
}

void sim_machine_probe_direction(const sim_machine_t *machine, const sim_stance_t *stance,
                                 const double in_probe[3], double in_machine[3])
{
    for (int i = 0; i < 3; ++i) {
        in_machine[i] = in_probe[i];
    }
    carry_all(machine, machine->head, stance, false, in_machine);
}

double sim_machine_distance_mm(const sim_machine_t *machine, const sim_stance_t *stance,
                               const double start_mm[3], const double direction[3])
{
    double centre_mm[3];
    double tip_mm[3];
    double way[3];
    double reach_mm = machine->sphere_radius_mm + machine->tip_radius_mm;

    sim_machine_sphere(machine, stance, centre_mm);
    sim_machine_tip(machine, stance, start_mm, tip_mm);
    stretch(machine, direction, way);
    double to_centre[3] = {centre_mm[0] - tip_mm[0], centre_mm[1] - tip_mm[1],
                           centre_mm[2] - tip_mm[2]};
    double length = sqrt(dot(way, way)); /* real mm a mm of reading */
    double nearest_mm = dot(to_centre, way) / length;
    double miss_squared = dot(to_centre, to_centre) - nearest_mm * nearest_mm;
    double half_chord_squared = reach_mm * reach_mm - miss_squared;
    return half_chord_squared < 0.0 ? (double)NAN
                                    : (nearest_mm - sqrt(half_chord_squared)) / length;
}
