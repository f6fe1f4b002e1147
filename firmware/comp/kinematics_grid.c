#include "comp/kinematics_grid.h"

#include <math.h>

#define AXES     KINEMATICS_GRID_AXES
#define TURN_DEG 360.0
#define CORNERS  8u /* of the cell that an angle lies in */

static uint8_t nodes_of(const kinematics_grid_t *grid, uint8_t axis)
{
    return grid->count[axis] > 0u ? grid->count[axis] : 1u;
}

/* Index of the node at 0°; the number of nodes if there is none. */
static uint8_t zero_of(const kinematics_grid_t *grid, uint8_t axis)
{
    uint8_t node = 0u;
    while (node < grid->count[axis] && fabs(grid->node_deg[axis][node]) > 0.0) {
        node++;
    }
    return node;
}

static bool is_axis(const kinematics_grid_t *grid, uint8_t axis)
{
    const double *node_deg = grid->node_deg[axis];
    uint8_t       count = grid->count[axis];
    if (count == 0u) {
        return true;
    }
    if (count > KINEMATICS_GRID_NODES_MAX) {
        return false;
    }
    bool sound = zero_of(grid, axis) < count && node_deg[0] >= -TURN_DEG &&
                 node_deg[count - 1u] <= TURN_DEG && node_deg[count - 1u] - node_deg[0] <= TURN_DEG;
    for (uint8_t i = 1u; i < count; i++) {
        sound = sound && node_deg[i] > node_deg[i - 1u];
    }
    return sound;
}

bool kinematics_grid_is_sound(const kinematics_grid_t *grid)
{
    uint16_t positions = 1u;
    for (uint8_t axis = 0u; axis < AXES; axis++) {
        if (!is_axis(grid, axis)) {
            return false;
        }
        positions = (uint16_t)(positions * nodes_of(grid, axis));
    }
    return positions >= 2u && positions <= KINEMATICS_GRID_POSITIONS_MAX;
}

uint8_t kinematics_grid_positions(const kinematics_grid_t *grid)
{
    return (uint8_t)(nodes_of(grid, 0u) * nodes_of(grid, 1u) * nodes_of(grid, 2u));
}

void kinematics_grid_angles(const kinematics_grid_t *grid, uint8_t position, double *angle_deg)
{
    for (uint8_t i = AXES; i > 0u; i--) {
        uint8_t axis = (uint8_t)(i - 1u);
        uint8_t node = (uint8_t)(position % nodes_of(grid, axis));
        position = (uint8_t)(position / nodes_of(grid, axis));
        angle_deg[axis] = grid->count[axis] > 0u ? grid->node_deg[axis][node] : 0.0;
    }
}

uint8_t kinematics_grid_reference(const kinematics_grid_t *grid)
{
    uint8_t position = 0u;
    for (uint8_t axis = 0u; axis < AXES; axis++) {
        position = (uint8_t)(position * nodes_of(grid, axis) + zero_of(grid, axis));
    }
    return position;
}

/* The node below an angle, and how far from it to the next one. */
typedef struct {
    uint8_t below;
    double  share;
} place_t;

static place_t place_of(const kinematics_grid_t *grid, uint8_t axis, double angle_deg)
{
    const double *node_deg = grid->node_deg[axis];
    uint8_t       last = (uint8_t)(nodes_of(grid, axis) - 1u);
    place_t       place = {0u, 0.0};
    if (last == 0u) {
        return place;
    }
    if (angle_deg < node_deg[0] || angle_deg > node_deg[last]) {
        /* An axis that turns on shows the same place again. */
        double middle_deg = 0.5 * (node_deg[0] + node_deg[last]);
        angle_deg -= TURN_DEG * round((angle_deg - middle_deg) / TURN_DEG);
    }
    while (place.below + 1u < last && angle_deg >= node_deg[place.below + 1u]) {
        place.below++;
    }
    double width_deg = node_deg[place.below + 1u] - node_deg[place.below];
    double share = (angle_deg - node_deg[place.below]) / width_deg;
    place.share = fmin(fmax(share, 0.0), 1.0);
    return place;
}

void kinematics_grid_interpolate(const kinematics_grid_t *grid, const double *table_mm,
                                 const double *angle_deg, double *offset_mm)
{
    place_t place[AXES];
    for (uint8_t axis = 0u; axis < AXES; axis++) {
        place[axis] = place_of(grid, axis, angle_deg[axis]);
        offset_mm[axis] = 0.0;
    }
    for (uint8_t corner = 0u; corner < CORNERS; corner++) {
        double   weight = 1.0;
        uint16_t position = 0u;
        for (uint8_t axis = 0u; axis < AXES; axis++) {
            uint8_t next = (uint8_t)((corner >> axis) % 2);
            weight *= next == 1u ? place[axis].share : 1.0 - place[axis].share;
            position = (uint16_t)(position * nodes_of(grid, axis) + place[axis].below + next);
        }
        for (uint8_t i = 0u; i < 3u && weight > 0.0; i++) {
            offset_mm[i] += weight * table_mm[3u * position + i];
        }
    }
}
