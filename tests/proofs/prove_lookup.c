/*
 * The table of speeds, any direction: no overflow, and a place within its face of the octahedron.
 *
 * In two steps. Lengths: x + y is at most the sum. Division, digit by digit: with s the parts of
 * the whole that x and y leave, and the rests rx and ry of the division, s * sum >= rx + ry holds
 * before the first digit and after each; so x + y stays within the face. (As rests are at most the
 * sum, from s = 2 on it holds whatever they are.) What stands in the table at a place is for the
 * tests.
 */
/* CBMC: --unwind 9 --object-bits 10 */
/* MUTANT: firmware/comp/pretravel_lookup.c: upper > LENGTH_MAX >> 8 => false */
#include "any.h"
#include "comp/pretravel_lookup.c"

#define SUM_MAX (3u * (LENGTH_MAX + 1u) - 1u) /* -32768 is one longer */

static void prove_lengths(void)
{
    int16_t dz = nondet_i16();
    ASSUME(dz >= 0);
    lengths_t lengths = lengths_of(nondet_i16(), nondet_i16(), dz);
    PROVE(lengths.sum <= SUM_MAX && (uint32_t)lengths.x + lengths.y <= lengths.sum);
}

static bool leaves_enough(int parts, uint16_t sum, uint32_t rests)
{
    return parts >= 2 || (parts == 1 && rests <= sum) || (parts == 0 && rests == 0u);
}

static void prove_a_digit(void)
{
    uint16_t sum = nondet_u16();
    uint16_t rest_x = nondet_u16();
    uint16_t rest_y = nondet_u16();
    uint8_t  parts = nondet_u8();
    uint8_t  x = 0u;
    uint8_t  y = 0u;
    ASSUME(sum >= 1u && sum <= SUM_MAX && rest_x <= sum && rest_y <= sum && parts <= 128u);
    ASSUME(leaves_enough(parts, sum, (uint32_t)rest_x + rest_y));

    DIVIDE_ON(rest_x, sum, x);
    DIVIDE_ON(rest_y, sum, y);
    PROVE(rest_x <= sum && rest_y <= sum && x <= 1u && y <= 1u);
    PROVE(leaves_enough(2 * parts - x - y, sum, (uint32_t)rest_x + rest_y));
}

int main(void)
{
    prove_lengths();
    prove_a_digit();
    return 0;
}
