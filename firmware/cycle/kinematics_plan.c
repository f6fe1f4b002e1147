#include "cycle/kinematics_plan.h"

#include <math.h>

#define FULL_TURN_DEG  360.0
#define SAME_ANGLE_DEG 5e-5 /* half of what the settings resolve */

/* What the document numbers for each axis, from Q411, Q415 and Q419 on. */
enum { START, END, INCIDENCE, POINTS, SETTINGS_PER_AXIS };

static double setting_of(const kinematics_settings_t *settings, uint8_t axis, uint8_t which)
{
    return settings->value[KINEMATICS_Q411_START_A + axis * SETTINGS_PER_AXIS + which];
}

uint8_t kinematics_plan_incidence(uint8_t axis)
{
    return (uint8_t)(KINEMATICS_Q411_START_A + axis * SETTINGS_PER_AXIS + INCIDENCE);
}

static double on_grid(double angle_deg, double grid_deg)
{
    double tie = copysign(SAME_ANGLE_DEG, angle_deg); /* stays one in spite of rounding */
    return grid_deg > 0.0 ? round((angle_deg + tie) / grid_deg) * grid_deg : angle_deg;
}

static bool is_reference(double angle_deg)
{
    double over = fmod(fabs(angle_deg), FULL_TURN_DEG);
    return over < SAME_ANGLE_DEG || over > FULL_TURN_DEG - SAME_ANGLE_DEG;
}

uint8_t kinematics_plan_positions(double start_deg, double end_deg, uint8_t points, double grid_deg,
                                  double *positions_deg)
{
    double  step = points > 1u ? (end_deg - start_deg) / (points - 1) : 0.0;
    uint8_t count = 0u;

    for (uint8_t i = 0u; i < points; i++) {
        double position = on_grid(start_deg + i * step, grid_deg);
        if (!is_reference(position)) {
            positions_deg[count++] = position;
        }
    }
    return count;
}

/* ---- stations ---- */

typedef struct {
    kinematics_plan_t            *plan;
    const kinematics_settings_t  *settings;
    const kinematics_plan_axis_t *axes;
    uint8_t                       axis;
} planner_t;

/* Axis at `angle`, the others that are there at their incidence angles. */
static kinematics_station_t station_at(const planner_t *planner, double angle_deg, double side_deg)
{
    kinematics_station_t station = {
        .axis = planner->axis,
        .serves = (uint8_t)(1u << planner->axis),
        .approach = (int8_t)((side_deg > 0.0) - (side_deg < 0.0)),
    };
    for (uint8_t i = 0u; i < ROTARY_AXES; i++) {
        double incidence = setting_of(planner->settings, i, INCIDENCE);
        bool   is_there = planner->axes[i].is_present;
        station.angle_deg[i] = is_there ? on_grid(incidence, planner->axes[i].grid_deg) : 0.0;
    }
    station.angle_deg[planner->axis] = angle_deg;
    return station;
}

bool kinematics_plan_is_there(double angle_deg, double target_deg)
{
    return fabs(angle_deg - target_deg) < SAME_ANGLE_DEG;
}

bool kinematics_plan_is_pose(const double *angles_deg, const double *others_deg)
{
    for (uint8_t i = 0u; i < ROTARY_AXES; i++) {
        if (!kinematics_plan_is_there(angles_deg[i], others_deg[i])) {
            return false;
        }
    }
    return true;
}

static void append(kinematics_plan_t *plan, const kinematics_station_t *station)
{
    plan->stations[plan->count++] = *station;
}

static void add_reference(const planner_t *planner)
{
    kinematics_station_t reference =
        station_at(planner, 0.0, planner->plan->side_deg[planner->axis]);
    reference.is_reference = true;
    for (uint8_t i = 0u; i < planner->plan->count; i++) {
        kinematics_station_t *other = &planner->plan->stations[i];
        if (other->is_reference && kinematics_plan_is_pose(other->angle_deg, reference.angle_deg)) {
            other->serves |= reference.serves;
            return;
        }
    }
    append(planner->plan, &reference);
}

/* The sphere alone, where no axis is measured. */
static void add_sphere(const planner_t *planner)
{
    kinematics_station_t station = station_at(planner, 0.0, 0.0);
    station.is_reference = true;
    station.serves = 0u;
    append(planner->plan, &station);
}

static void add_axis(const planner_t *planner, bool may_reverse)
{
    const kinematics_settings_t *settings = planner->settings;
    double                       positions[KINEMATICS_POINTS_MAX];
    uint8_t count = kinematics_plan_positions(setting_of(settings, planner->axis, START),
                                              setting_of(settings, planner->axis, END),
                                              (uint8_t)setting_of(settings, planner->axis, POINTS),
                                              planner->axes[planner->axis].grid_deg, positions);
    double  side_deg =
        may_reverse && count > 0u ? settings->value[KINEMATICS_Q432_BACKLASH_ANGLE] : 0.0;

    planner->plan->side_deg[planner->axis] = side_deg;
    if (count > 0u) {
        add_reference(planner);
    }
    for (uint8_t i = 0u; i < count; i++) {
        kinematics_station_t first = station_at(planner, positions[i], side_deg);
        kinematics_station_t second = station_at(planner, positions[i], -side_deg);
        append(planner->plan, &first);
        second.is_second = true;
        if (first.approach != 0) {
            append(planner->plan, &second);
        }
    }
}

void kinematics_plan_make(kinematics_plan_t *plan, const kinematics_settings_t *settings,
                          const kinematics_plan_axis_t *axes, bool may_reverse)
{
    plan->count = 0u;
    plan->measured = 0u;
    for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
        bool has_grid = axes[axis].grid_deg > 0.0;
        plan->side_deg[axis] = 0.0;
        if (axes[axis].is_present) {
            add_axis(&(planner_t){plan, settings, axes, axis}, may_reverse && !has_grid);
        }
    }
    if (plan->count == 0u && settings->kind == KINEMATICS_COMPENSATE_PRESET) {
        add_sphere(&(planner_t){plan, settings, axes, ROTARY_A});
    }
}

static void add_position(kinematics_plan_t *plan, const kinematics_grid_t *grid, uint8_t position)
{
    kinematics_station_t station = {
        .axis = ROTARY_A,
        .is_reference = position == kinematics_grid_reference(grid),
    };
    kinematics_grid_angles(grid, position, station.angle_deg);
    append(plan, &station);
}

void kinematics_plan_make_grid(kinematics_plan_t *plan, const kinematics_grid_t *grid)
{
    uint8_t count = kinematics_grid_positions(grid);
    uint8_t reference = kinematics_grid_reference(grid);

    plan->count = 0u;
    plan->measured = 0u;
    for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
        plan->side_deg[axis] = 0.0;
    }
    add_position(plan, grid, reference);
    for (uint8_t position = 0u; position < count; position++) {
        if (position != reference) {
            add_position(plan, grid, position);
        }
    }
}

bool kinematics_plan_grid_fits(const kinematics_grid_t *grid, const kinematics_plan_axis_t *axes)
{
    bool fits = true;
    for (uint8_t axis = 0u; axis < ROTARY_AXES; axis++) {
        for (uint8_t i = 0u; i < grid->count[axis]; i++) {
            double node_deg = grid->node_deg[axis][i];
            fits = fits && axes[axis].is_present &&
                   kinematics_plan_is_there(on_grid(node_deg, axes[axis].grid_deg), node_deg);
        }
    }
    return fits;
}

bool kinematics_plan_measures(const kinematics_plan_t *plan, uint8_t axis)
{
    bool measures = false;
    for (uint8_t i = 0u; i < plan->count; i++) {
        measures = measures || (plan->stations[i].serves & (1u << axis)) != 0u;
    }
    return measures;
}
