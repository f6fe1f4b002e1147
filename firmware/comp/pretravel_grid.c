#include "comp/pretravel_grid.h"

#include <math.h>
#include <stdlib.h>

#define DEG_PER_RAD 57.29577951308232

uint32_t pretravel_grid_size(uint8_t divisions)
{
    uint32_t m = divisions;
    return 2u * m * m + 2u * m + 1u;
}

/* Vertex (i, j) lies in the direction (i, j, M − |i| − |j|). */
static double vertex_speed(const pretravel_cell_t *cells, const double *speed_mm_min,
                           uint32_t count, int divisions, int i, int j)
{
    int    height = divisions - abs(i) - abs(j);
    double across = sqrt((double)(i * i + j * j));
    double alpha_deg = atan2((double)j, (double)i) * DEG_PER_RAD;
    double beta_deg = atan2((double)height, across) * DEG_PER_RAD;
    return pretravel_map_at(cells, speed_mm_min, count, alpha_deg, beta_deg);
}

static int write_vertex(double units, uint8_t *vertex)
{
    if (!(units >= 0.5 && units < (double)PRETRAVEL_VERTEX_MAX + 0.5)) {
        return PRETRAVEL_ERR_SCALE;
    }
    *vertex = (uint8_t)(units + 0.5);
    return PRETRAVEL_OK;
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
    for (int j = -m; j <= m; j++) {
        for (int i = abs(j) - m; i <= m - abs(j); i++) {
            double speed = vertex_speed(cells, speed_mm_min, count, m, i, j);
            int    code = write_vertex(speed / unit_mm_min, vertices);
            if (code != PRETRAVEL_OK) {
                return code;
            }
            vertices++;
        }
    }
    return PRETRAVEL_OK;
}
