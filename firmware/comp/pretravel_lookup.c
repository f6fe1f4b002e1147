#include "comp/pretravel_lookup.h"

#include <stdbool.h>

/*
 * 2^31 / (2^15 + 512·k) less 6: so much that between two entries the straight line, which lies
 * above the curve, stays below it. A share that is never too great keeps within the rim.
 */
static const uint16_t RECIPROCALS[] = {
    65530u, 64521u, 63544u, 62595u, 61674u, 60781u, 59912u, 59068u, 58248u, 57450u, 56673u,
    55918u, 55182u, 54465u, 53767u, 53086u, 52422u, 51775u, 51144u, 50527u, 49926u, 49338u,
    48764u, 48204u, 47656u, 47121u, 46597u, 46085u, 45584u, 45094u, 44614u, 44144u, 43684u,
    43234u, 42793u, 42360u, 41937u, 41521u, 41114u, 40715u, 40323u, 39939u, 39562u, 39193u,
    38830u, 38473u, 38124u, 37780u, 37443u, 37111u, 36786u, 36466u, 36151u, 35842u, 35538u,
    35240u, 34946u, 34657u, 34373u, 34094u, 33819u, 33548u, 33282u, 33020u, 32762u,
};

/* How far into a triangle: the corner it counts from, and the way from there in 2^-16. */
typedef struct {
    uint8_t  corner;
    uint16_t way;
} share_t;

/* Upper half of the product. */
static uint16_t times(uint16_t a, uint16_t b)
{
    return (uint16_t)((uint32_t)a * b >> 16);
}

static uint16_t magnitude(int16_t value)
{
    return value < 0 ? (uint16_t)(0u - (uint16_t)value) : (uint16_t)value;
}

/* A little below 2^31 / sum, for a sum of 2^15 or more. */
static uint16_t reciprocal(uint16_t sum)
{
    const uint16_t *entry = &RECIPROCALS[(uint8_t)(sum >> 8) >> 1 & 0x3Fu];
    return (uint16_t)(entry[0] - times((uint16_t)(entry[0] - entry[1]), (uint16_t)(sum << 7)));
}

static share_t share_of(uint16_t length, uint16_t per_sum, uint8_t divisions)
{
    uint32_t share = (uint32_t)times(length, per_sum) * (uint16_t)(divisions << 1);
    return (share_t){(uint8_t)(share >> 16), (uint16_t)share};
}

/* How much is to be added to `from` on the way to `to`, modulo 2^16. */
static uint16_t part(uint16_t from, uint16_t to, uint16_t way)
{
    return to >= from ? times((uint16_t)(to - from), way)
                      : (uint16_t)(0u - times((uint16_t)(from - to), way));
}

static uint16_t interpolate(uint16_t corner, uint16_t to_x, uint16_t x_way, uint16_t to_y,
                            uint16_t y_way)
{
    return (uint16_t)(corner + part(corner, to_x, x_way) + part(corner, to_y, y_way));
}

/* Counted from the pole, row j begins (M − |j|)·(M − |j| + 1) vertices from the end of the table.
 */
static uint16_t speed_at(const pretravel_lookup_t *lookup, share_t x, share_t y, bool is_left,
                         bool is_below)
{
    uint8_t         rows_left = (uint8_t)(lookup->divisions - y.corner);
    uint16_t        half = (uint16_t)(lookup->divisions * (lookup->divisions + 1u));
    int16_t         row = (int16_t)(half - (uint16_t)(rows_left * (rows_left + 1u)));
    int16_t         row_step = (int16_t)(2u * rows_left);
    int16_t         step = is_left ? -1 : 1;
    const uint16_t *near = lookup->speed + half + (is_left ? -x.corner : x.corner);
    const uint16_t *next;
    if (is_below) {
        near -= row;
        next = near - row_step;
    } else {
        near += row;
        next = near + row_step;
    }
    if ((uint16_t)(x.way + y.way) >= x.way) { /* no carry: the triangle at the near corner */
        return interpolate(near[0], near[step], x.way, next[0], y.way);
    }
    return interpolate(next[step], next[0], (uint16_t)(0u - x.way), near[step],
                       (uint16_t)(0u - y.way));
}

uint16_t pretravel_lookup(const pretravel_lookup_t *lookup, int16_t dx, int16_t dy, int16_t dz)
{
    uint16_t x = magnitude(dx);
    uint16_t y = magnitude(dy);
    uint16_t z = magnitude(dz);
    if ((x | y | z) >= 0x4000u) { /* the sum shall fit */
        x >>= 1;
        y >>= 1;
        z >>= 1;
    }
    uint16_t sum = (uint16_t)(x + y + z);
    if (dz < 0 || sum == 0u) {
        return PRETRAVEL_NO_SPEED;
    }
    if (sum < 0x100u) {
        x = (uint16_t)(x << 8);
        y = (uint16_t)(y << 8);
        sum = (uint16_t)(sum << 8);
    }
    while (sum < 0x8000u) {
        x = (uint16_t)(x << 1);
        y = (uint16_t)(y << 1);
        sum = (uint16_t)(sum << 1);
    }
    uint16_t per_sum = reciprocal(sum);
    return speed_at(lookup, share_of(x, per_sum, lookup->divisions),
                    share_of(y, per_sum, lookup->divisions), dx < 0, dy < 0);
}
