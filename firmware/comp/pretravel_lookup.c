#include "comp/pretravel_lookup.h"

#include <stdbool.h>

/* Written for eight bits: products of two bytes are one step there, and a length must not reach
   the upper bit, because it is doubled. */
#define LENGTH_MAX  0x1FFFu /* a component, so that three of them fit */
#define SCALE_SHIFT 2       /* from the longest component to that */

#define WHOLE ((uint8_t)PRETRAVEL_LOOKUP_PARTS)

/* A vector without its signs, flattened later by dividing by the sum. */
typedef struct {
    uint16_t x;
    uint16_t y;
    uint16_t sum; /* of all three components */
} lengths_t;

/* In one face of the octahedron: the corner (x, y) nearest to the pole of the square of two
   triangles, and the way from there in 1/128 of a triangle's side. */
typedef struct {
    uint8_t x;
    uint8_t y;
    uint8_t way_x;
    uint8_t way_y;
} place_t;

static uint16_t magnitude(int16_t value)
{
    return value < 0 ? (uint16_t)(0u - (uint16_t)value) : (uint16_t)value;
}

static lengths_t lengths_of(int16_t dx, int16_t dy, int16_t dz)
{
    lengths_t lengths = {magnitude(dx), magnitude(dy), (uint16_t)dz};
    uint8_t   upper = (uint8_t)((lengths.x >> 8) | (lengths.y >> 8) | (lengths.sum >> 8));
    if (upper > LENGTH_MAX >> 8) {
        lengths.x >>= SCALE_SHIFT;
        lengths.y >>= SCALE_SHIFT;
        lengths.sum >>= SCALE_SHIFT;
    }
    lengths.sum = (uint16_t)(lengths.sum + lengths.x + lengths.y);
    return lengths;
}

/* Long division, one binary digit of the quotient. A function would not be taken in by a compiler
   that looks for small code, and cost four times as many cycles. */
#define DIVIDE_ON(rest, sum, quotient)           \
    do {                                         \
        (rest) = (uint16_t)((rest) << 1);        \
        (quotient) = (uint8_t)((quotient) << 1); \
        if ((rest) >= (sum)) {                   \
            (rest) = (uint16_t)((rest) - (sum)); \
            (quotient)++;                        \
        }                                        \
    } while (false)

/* A 1 that is shifted along with the digits of x says when there are enough of them. */
static void find_corner(lengths_t *lengths, uint8_t divisions, place_t *place)
{
    place->x = 1u;
    place->y = 0u;
    do {
        DIVIDE_ON(lengths->x, lengths->sum, place->x);
        DIVIDE_ON(lengths->y, lengths->sum, place->y);
    } while (place->x < divisions);
    place->x = (uint8_t)(place->x - divisions);
}

/* The digits that follow. */
static void find_way(lengths_t *lengths, place_t *place)
{
    place->way_x = 1u;
    place->way_y = 0u;
    do {
        DIVIDE_ON(lengths->x, lengths->sum, place->way_x);
        DIVIDE_ON(lengths->y, lengths->sum, place->way_y);
    } while (place->way_x < WHOLE);
    place->way_x = (uint8_t)(place->way_x - WHOLE);
}

/* Row y begins y·(2·M + 1 − y) vertices from the pole, at x = 0; the next one 2·(M − y) later. */
static uint16_t speed_at(const pretravel_lookup_t *lookup, place_t at, bool is_left, bool is_below)
{
    uint8_t to_x = 1u;
    uint8_t to_y = (uint8_t)((uint8_t)(lookup->divisions - at.y) << 1);
    uint8_t near = (uint8_t)(WHOLE - at.way_x - at.way_y);
    if (near > WHOLE) { /* below 0: the far triangle, seen from the opposite corner */
        at = (place_t){(uint8_t)(at.x + 1u), (uint8_t)(at.y + 1u), (uint8_t)(WHOLE - at.way_x),
                       (uint8_t)(WHOLE - at.way_y)};
        near = (uint8_t)(0u - near);
        to_x = (uint8_t)(0u - to_x);
        to_y = (uint8_t)(0u - to_y);
    }
    uint8_t        longest = (uint8_t)((lookup->divisions << 1) + 1);
    uint16_t       row = (uint16_t)(at.y * (uint8_t)(longest - at.y));
    const uint8_t *corner = lookup->pole;
    if (is_left) {
        corner -= at.x;
        to_x = (uint8_t)(0u - to_x);
    } else {
        corner += at.x;
    }
    if (is_below) {
        corner -= row;
        to_y = (uint8_t)(0u - to_y);
    } else {
        corner += row;
    }
    if (near == WHOLE) { /* a vertex, on the rim perhaps, beyond which there is none */
        return (uint16_t)(*corner * WHOLE);
    }
    return (uint16_t)(*corner * near + corner[(int8_t)to_x] * at.way_x +
                      corner[(int8_t)to_y] * at.way_y);
}

uint16_t pretravel_lookup(const pretravel_lookup_t *lookup, int16_t dx, int16_t dy, int16_t dz)
{
    if (dz < 0) {
        return PRETRAVEL_NO_SPEED;
    }
    lengths_t lengths = lengths_of(dx, dy, dz);
    if (lengths.sum == 0u) {
        return PRETRAVEL_NO_SPEED;
    }
    place_t place;
    find_corner(&lengths, lookup->divisions, &place);
    find_way(&lengths, &place);
    return speed_at(lookup, place, dx < 0, dy < 0);
}
