/* Random numbers for tests, the same on every run; not those of the simulation. */
#ifndef SUPPORT_DICE_H
#define SUPPORT_DICE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t state;
} dice_t;

dice_t dice_seed(uint64_t seed);

uint64_t dice_bits(dice_t *dice);

/* Uniform in 0 … below − 1. */
uint32_t dice_below(dice_t *dice, uint32_t below);

/* Uniform in [low, high). */
double dice_between(dice_t *dice, double low, double high);

/* As many small as large ones; low > 0. */
double dice_any_scale(dice_t *dice, double low, double high);

#endif
