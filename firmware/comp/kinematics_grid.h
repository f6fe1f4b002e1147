/*
 * A grid of positions of the rotary axes, and a table of compensation over it: where a machine's
 * axes do not turn as any straight line says, what is left after their location errors is measured
 * on the grid (cycle 453) and added to what the linear axes are expected to read. Lengths in mm,
 * angles in degrees, axes in the order A, B, C.
 */
#ifndef COMP_KINEMATICS_GRID_H
#define COMP_KINEMATICS_GRID_H

#include <stdbool.h>
#include <stdint.h>

#define KINEMATICS_GRID_AXES          3
#define KINEMATICS_GRID_NODES_MAX     25
#define KINEMATICS_GRID_POSITIONS_MAX 75

#ifdef __cplusplus
extern "C" {
#endif

/* The positions: each node of A with each of B and each of C; C is the fastest. */
typedef struct {
    uint8_t count[KINEMATICS_GRID_AXES]; /* nodes; 0: the axis is none of the grid, at 0° */
    double  node_deg[KINEMATICS_GRID_AXES][KINEMATICS_GRID_NODES_MAX];
} kinematics_grid_t;

/*
 * Whether every axis of the grid has rising nodes within ±360° and one turn, 0° among them, and all
 * together 2 to KINEMATICS_GRID_POSITIONS_MAX positions. Any context.
 */
bool kinematics_grid_is_sound(const kinematics_grid_t *grid);

/* How many positions a sound grid has, where one of them is, and which of them has all axes at 0°.
 * Any context. */
uint8_t kinematics_grid_positions(const kinematics_grid_t *grid);
void    kinematics_grid_angles(const kinematics_grid_t *grid, uint8_t position, double *angle_deg);
uint8_t kinematics_grid_reference(const kinematics_grid_t *grid);

/*
 * What a table, three coordinates a position, has at any angles: linear in each axis between its
 * nodes, the nearest node beyond them; a full turn changes nothing. `grid` is sound. Any context.
 */
void kinematics_grid_interpolate(const kinematics_grid_t *grid, const double *table_mm,
                                 const double *angle_deg, double *offset_mm);

#ifdef __cplusplus
}
#endif

#endif
