#include "dice.h"

#include <math.h>

dice_t dice_seed(uint64_t seed)
{
    return (dice_t){seed};
}

/* SplitMix64. */
uint64_t dice_bits(dice_t *dice)
{
    uint64_t z = dice->state += 0x9E3779B97F4A7C15ull;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ z >> 27) * 0x94D049BB133111EBull;
    return z ^ z >> 31;
}

uint32_t dice_below(dice_t *dice, uint32_t below)
{
    return (uint32_t)((dice_bits(dice) >> 32) * below >> 32);
}

double dice_between(dice_t *dice, double low, double high)
{
    return low + (high - low) * ((double)(dice_bits(dice) >> 11) / 9007199254740992.0);
}

double dice_any_scale(dice_t *dice, double low, double high)
{
    return low * exp(dice_between(dice, 0.0, log(high / low)));
}
