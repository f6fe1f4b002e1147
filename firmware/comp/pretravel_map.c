#include "comp/pretravel_map.h"

#include <math.h>
#include <stdbool.h>

#define TURN_DEG   360.0
#define POLE_DEG   90.0
#define SAME_DEG   1.0e-3
#define GAP_FACTOR 1.5

static bool is_pole(double beta_deg)
{
    return beta_deg > POLE_DEG - SAME_DEG;
}

/* 0 ≤ α < 360; what rounding leaves just short of a turn is 0, and so is α at the pole. */
static double azimuth_of(double alpha_deg, double beta_deg)
{
    double turned_deg = fmod(alpha_deg, TURN_DEG);
    turned_deg += turned_deg < 0.0 ? TURN_DEG : 0.0;
    return is_pole(beta_deg) || turned_deg > TURN_DEG - SAME_DEG ? 0.0 : turned_deg;
}

/* Below, at or above the cell in their order: −1, 0, 1. */
static int compare(const pretravel_cell_t *cell, double alpha_deg, double beta_deg)
{
    double beta_off = beta_deg - cell->beta_deg;
    double off = fabs(beta_off) > SAME_DEG ? beta_off : alpha_deg - cell->alpha_deg;
    if (fabs(off) <= SAME_DEG) {
        return 0;
    }
    return off < 0.0 ? -1 : 1;
}

/* The cell of a direction, or else where it belongs. */
static uint32_t find_place(const pretravel_cell_t *cells, uint32_t count, double alpha_deg,
                           double beta_deg)
{
    uint32_t low = 0u;
    uint32_t high = count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2u;
        if (compare(&cells[middle], alpha_deg, beta_deg) > 0) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

static void insert_cell(pretravel_cell_t *cells, uint32_t count, uint32_t place, double alpha_deg,
                        double beta_deg)
{
    for (uint32_t i = count; i > place; i--) {
        cells[i] = cells[i - 1u];
    }
    cells[place] = (pretravel_cell_t){.alpha_deg = alpha_deg, .beta_deg = beta_deg};
}

/* Welford's running mean; while readings come in, scatter_um holds the sum of squares. */
static void add_reading(pretravel_cell_t *cell, double radius_um)
{
    double off_um = radius_um - cell->radius_um;
    cell->runs++;
    cell->radius_um += off_um / (double)cell->runs;
    cell->scatter_um += off_um * (radius_um - cell->radius_um);
}

static int check_reading(double alpha_deg, double beta_deg, double radius_um)
{
    if (!isfinite(alpha_deg) || !isfinite(beta_deg) || !isfinite(radius_um)) {
        return PRETRAVEL_ERR_NOT_FINITE;
    }
    bool is_direction = fabs(alpha_deg) <= TURN_DEG && beta_deg >= 0.0 && beta_deg <= POLE_DEG;
    return is_direction ? PRETRAVEL_OK : PRETRAVEL_ERR_DIRECTION;
}

int pretravel_map_build(const double *alpha_deg, const double *beta_deg, const double *radius_um,
                        uint32_t n, pretravel_cell_t *cells, uint32_t capacity, uint32_t *count)
{
    uint32_t filled = 0u;
    for (uint32_t i = 0; i < n; i++) {
        int code = check_reading(alpha_deg[i], beta_deg[i], radius_um[i]);
        if (code != PRETRAVEL_OK) {
            *count = i;
            return code;
        }
        double   azimuth_deg = azimuth_of(alpha_deg[i], beta_deg[i]);
        uint32_t place = find_place(cells, filled, azimuth_deg, beta_deg[i]);
        if (place == filled || compare(&cells[place], azimuth_deg, beta_deg[i]) != 0) {
            if (filled == capacity) {
                *count = i;
                return PRETRAVEL_ERR_CAPACITY;
            }
            insert_cell(cells, filled, place, azimuth_deg, beta_deg[i]);
            filled++;
        }
        add_reading(&cells[place], radius_um[i]);
    }
    for (uint32_t i = 0; i < filled; i++) {
        double runs = (double)cells[i].runs;
        cells[i].scatter_um = runs > 1.0 ? sqrt(cells[i].scatter_um / (runs - 1.0)) : (double)NAN;
    }
    *count = filled;
    return PRETRAVEL_OK;
}

/* Cells first … end − 1 have one β. */
typedef struct {
    uint32_t first;
    uint32_t end;
} row_t;

static row_t row_from(const pretravel_cell_t *cells, uint32_t count, uint32_t first)
{
    uint32_t end = first;
    while (end < count && cells[end].beta_deg - cells[first].beta_deg <= SAME_DEG) {
        end++;
    }
    return (row_t){first, end};
}

/* From one azimuth of the row to the next, across 360° after the last. */
static double azimuth_step(const pretravel_cell_t *cells, row_t row, uint32_t i)
{
    bool is_last = i + 1u == row.end;
    return is_last ? cells[row.first].alpha_deg + TURN_DEG - cells[i].alpha_deg
                   : cells[i + 1u].alpha_deg - cells[i].alpha_deg;
}

/* From the row of cell i to the next one, if i is the last of its row and not of the map; else 0.
 */
static double row_step(const pretravel_cell_t *cells, row_t all, uint32_t i)
{
    double step = i + 1u < all.end ? cells[i + 1u].beta_deg - cells[i].beta_deg : 0.0;
    return step > SAME_DEG ? step : 0.0;
}

typedef double (*step_t)(const pretravel_cell_t *cells, row_t row, uint32_t i);

/* Half of the steps, steps of 0 left out, are at most this long; of an even count, the lower half.
 */
static double median_step(const pretravel_cell_t *cells, row_t row, step_t step_of)
{
    double median = 0.0;
    for (uint32_t i = row.first; i < row.end; i++) {
        uint32_t at_most = 0u;
        uint32_t longer = 0u;
        double   step = step_of(cells, row, i);
        for (uint32_t k = row.first; k < row.end; k++) {
            double other = step_of(cells, row, k);
            at_most += other > 0.0 && other <= step ? 1u : 0u;
            longer += other > step ? 1u : 0u;
        }
        bool is_half = step > 0.0 && at_most >= longer;
        median = is_half && (median <= 0.0 || step < median) ? step : median;
    }
    return median;
}

static int find_gap(const pretravel_cell_t *cells, row_t row, step_t step_of, pretravel_gap_t *gap)
{
    double median = median_step(cells, row, step_of);
    for (uint32_t i = row.first; i < row.end; i++) {
        double step = step_of(cells, row, i);
        if (step > GAP_FACTOR * median) {
            *gap = (pretravel_gap_t){cells[i].alpha_deg, cells[i].beta_deg, step};
            return PRETRAVEL_ERR_GAP;
        }
    }
    return PRETRAVEL_OK;
}

int pretravel_map_check(const pretravel_cell_t *cells, uint32_t count, pretravel_gap_t *gap)
{
    int code = count < PRETRAVEL_DIRECTIONS_MIN ? PRETRAVEL_ERR_FEW_DIRECTIONS : PRETRAVEL_OK;
    for (row_t row = {0u, 0u}; row.end < count && code == PRETRAVEL_OK;) {
        row = row_from(cells, count, row.end);
        if (row.end - row.first >= PRETRAVEL_AZIMUTHS_MIN) {
            code = find_gap(cells, row, azimuth_step, gap);
        } else if (!is_pole(cells[row.first].beta_deg)) {
            code = PRETRAVEL_ERR_FEW_DIRECTIONS;
        }
    }
    return code == PRETRAVEL_OK ? find_gap(cells, (row_t){0u, count}, row_step, gap) : code;
}

static double between(double low, double high, double share)
{
    return low + share * (high - low);
}

static double row_mean(const double *values, row_t row)
{
    double sum = 0.0;
    for (uint32_t i = row.first; i < row.end; i++) {
        sum += values[i];
    }
    return sum / (double)(row.end - row.first);
}

static double row_at(const pretravel_cell_t *cells, const double *values, row_t row,
                     double azimuth_deg)
{
    uint32_t before = row.end - 1u; /* from the last azimuth across 360° to the first */
    for (uint32_t i = row.first; i < row.end && cells[i].alpha_deg <= azimuth_deg; i++) {
        before = i;
    }
    uint32_t after = before + 1u < row.end ? before + 1u : row.first;
    double   off_deg = azimuth_deg - cells[before].alpha_deg;
    off_deg += off_deg < 0.0 ? TURN_DEG : 0.0;
    return between(values[before], values[after], off_deg / azimuth_step(cells, row, before));
}

double pretravel_map_at(const pretravel_cell_t *cells, const double *values, uint32_t count,
                        double alpha_deg, double beta_deg)
{
    double azimuth_deg = azimuth_of(alpha_deg, 0.0);
    row_t  low = row_from(cells, count, 0u);
    row_t  high = low;
    while (high.end < count && cells[high.first].beta_deg <= beta_deg) {
        low = high;
        high = row_from(cells, count, high.end);
    }
    bool   is_past = cells[high.first].beta_deg <= beta_deg;
    row_t  from = is_past ? high : low;
    double low_deg = cells[from.first].beta_deg;
    double low_value = row_at(cells, values, from, azimuth_deg);
    double high_deg = is_past ? POLE_DEG : cells[high.first].beta_deg;
    double high_value = is_past ? row_mean(values, high) : row_at(cells, values, high, azimuth_deg);
    bool   is_between = beta_deg > low_deg && high_deg > low_deg;
    return is_between ? between(low_value, high_value, (beta_deg - low_deg) / (high_deg - low_deg))
                      : low_value;
}
