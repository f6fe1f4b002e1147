#include "comp/pretravel_grid.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#define DEG_PER_RAD 57.29577951308232

uint32_t pretravel_grid_size(uint8_t divisions)
{
    uint32_t m = divisions;
    return 2u * m * m + 2u * m + 1u;
}

typedef struct {
    const pretravel_cell_t *cells;
    const double           *speed_mm_min;
    uint32_t                count;
    int                     divisions;
    double                  slowest_mm_min;
    double                  fastest_mm_min;
} grid_t;

static grid_t grid_of(const pretravel_cell_t *cells, const double *speed_mm_min, uint32_t count,
                      int divisions)
{
    grid_t grid = {cells, speed_mm_min, count, divisions, speed_mm_min[0], speed_mm_min[0]};
    for (uint32_t i = 1; i < count; i++) {
        grid.slowest_mm_min = fmin(grid.slowest_mm_min, speed_mm_min[i]);
        grid.fastest_mm_min = fmax(grid.fastest_mm_min, speed_mm_min[i]);
    }
    return grid;
}

/* Vertex (i, j) lies in the direction (i, j, M − |i| − |j|); halves lie between vertices. */
static double exact_speed(const grid_t *grid, double i, double j)
{
    double height = (double)grid->divisions - fabs(i) - fabs(j);
    double alpha_deg = atan2(j, i) * DEG_PER_RAD;
    double beta_deg = atan2(height, sqrt(i * i + j * j)) * DEG_PER_RAD;
    return pretravel_map_at(grid->cells, grid->speed_mm_min, grid->count, alpha_deg, beta_deg);
}

/* A step along a row or a column is a side of a triangle, and so is one that keeps the height. */
static bool is_side(const grid_t *grid, int i, int j, int to_i, int to_j)
{
    int  ring = abs(i) + abs(j);
    int  to_ring = abs(to_i) + abs(to_j);
    bool is_diagonal = i != to_i && j != to_j;
    return to_ring <= grid->divisions && (!is_diagonal || to_ring == ring);
}

/*
 * Lines between true values lie on one side of whatever is bent, most of all at the edges between
 * lobes. Half of the greatest error at the middle of its sides, added to a vertex, evens that out.
 */
static double vertex_speed(const grid_t *grid, int i, int j)
{
    double here = exact_speed(grid, i, j);
    double worst = 0.0;
    for (int to_i = i - 1; to_i <= i + 1; to_i++) {
        for (int to_j = j - 1; to_j <= j + 1; to_j++) {
            if (is_side(grid, i, j, to_i, to_j)) {
                double middle = exact_speed(grid, (i + to_i) / 2.0, (j + to_j) / 2.0);
                double error = middle - (here + exact_speed(grid, to_i, to_j)) / 2.0;
                worst = fabs(error) > fabs(worst) ? error : worst;
            }
        }
    }
    return fmin(fmax(here + worst / 2.0, grid->slowest_mm_min), grid->fastest_mm_min);
}

/* False for a NaN as well. */
static bool do_fit(const double *speed_mm_min, uint32_t count, double unit_mm_min)
{
    for (uint32_t i = 0; i < count; i++) {
        double units = speed_mm_min[i] / unit_mm_min;
        if (!(units >= 0.5 && units < (double)PRETRAVEL_VERTEX_MAX + 0.5)) {
            return false;
        }
    }
    return true;
}

int pretravel_grid_build(const pretravel_cell_t *cells, const double *speed_mm_min, uint32_t count,
                         uint8_t divisions, double unit_mm_min, uint8_t *vertices)
{
    int m = divisions;
    if (m < 2 || m > PRETRAVEL_DIVISIONS_MAX || (m & (m - 1)) != 0) { /* a power of two */
        return PRETRAVEL_ERR_DIVISIONS;
    }
    if (!(unit_mm_min > 0.0)) {
        return PRETRAVEL_ERR_LIMIT;
    }
    if (!do_fit(speed_mm_min, count, unit_mm_min)) {
        return PRETRAVEL_ERR_SCALE;
    }
    const grid_t grid = grid_of(cells, speed_mm_min, count, m);
    for (int j = -m; j <= m; j++) {
        for (int i = abs(j) - m; i <= m - abs(j); i++) {
            *vertices++ = (uint8_t)(vertex_speed(&grid, i, j) / unit_mm_min + 0.5);
        }
    }
    return PRETRAVEL_OK;
}
