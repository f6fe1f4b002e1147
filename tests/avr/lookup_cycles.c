/*
 * Runs the controller's lookup on an ATmega and tells over the serial line, in one line:
 * directions, the most cycles of a call and the mean, the direction that took most, and a checksum
 * of all speeds. tests/python/test_lookup_avr.py runs it in simavr and plays the same on the host.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "comp/pretravel_lookup.h"

#ifndef DIVISIONS
#define DIVISIONS 16u
#endif
#define VERTICES   (2u * DIVISIONS * DIVISIONS + 2u * DIVISIONS + 1u)
#define DIRECTIONS 16384u

#define NOTHING_CYCLES 10u /* its call, its return, and its result of 0 */

typedef struct {
    int16_t dx;
    int16_t dy;
    int16_t dz;
} direction_t;

typedef struct {
    uint32_t    sum;
    uint16_t    most;
    direction_t worst;
    uint32_t    checksum;
} outcome_t;

static uint8_t  vertices[VERTICES];
static uint32_t random_state = 1u;

static uint16_t next_random(void)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint16_t)(random_state >> 16);
}

/*
 * Every other direction is any, long or short. The rest lie where the long division subtracts most
 * often, near x = y on the equator, with both signs negative.
 */
static direction_t next_direction(bool is_any)
{
    uint8_t  shift = (uint8_t)(next_random() % 14u);
    uint16_t x = next_random();
    uint16_t y = next_random();
    uint16_t z = next_random();
    if (is_any) {
        return (direction_t){(int16_t)((int16_t)x >> shift), (int16_t)((int16_t)y >> shift),
                             (int16_t)((z & 0x7FFFu) >> shift)};
    }
    uint16_t side = (uint16_t)((x & 0x3FFFu) | 0x4000u);
    return (direction_t){(int16_t)-side, (int16_t)-(int16_t)(side - (y & 0xFFu)),
                         (int16_t)(z >> (shift + 2u))};
}

typedef uint16_t (*lookup_t)(const pretravel_lookup_t *lookup, int16_t dx, int16_t dy, int16_t dz);

__attribute__((noinline)) static uint16_t nothing(const pretravel_lookup_t *lookup, int16_t dx,
                                                  int16_t dy, int16_t dz)
{
    __asm__ volatile("" ::"r"(lookup), "r"(dx), "r"(dy), "r"(dz));
    return 0u;
}

/* Between two readings of a counter that runs at the processor's clock. */
__attribute__((noinline, noclone)) static uint16_t time_call(lookup_t                  call,
                                                             const pretravel_lookup_t *lookup,
                                                             direction_t direction, uint16_t *speed)
{
    uint16_t start = TCNT1;
    *speed = call(lookup, direction.dx, direction.dy, direction.dz);
    return (uint16_t)(TCNT1 - start);
}

/* What a function that does nothing takes is the timing's, but for the cycles of its own. */
static uint16_t cycles_of(const pretravel_lookup_t *lookup, direction_t direction, uint16_t *speed)
{
    uint16_t empty = time_call(nothing, lookup, direction, speed);
    uint16_t full = time_call(pretravel_lookup, lookup, direction, speed);
    return (uint16_t)(full - empty + NOTHING_CYCLES);
}

static void tell(uint32_t value)
{
    char digits[12];
    ultoa(value, digits, 10);
    for (const char *digit = digits; *digit != '\0'; digit++) {
        UDR0 = (uint8_t)*digit;
    }
    UDR0 = ' ';
}

int main(void)
{
    const pretravel_lookup_t lookup = {.pole = vertices + VERTICES / 2u, .divisions = DIVISIONS};
    outcome_t                outcome = {0};
    TCCR1B = (uint8_t)(1u << CS10);
    UCSR0B = (uint8_t)(1u << TXEN0);
    for (uint16_t i = 0; i < VERTICES; i++) {
        vertices[i] = (uint8_t)next_random();
    }
    for (uint16_t i = 0; i < DIRECTIONS; i++) {
        direction_t direction = next_direction((i & 1u) != 0u);
        uint16_t    speed = 0u;
        uint16_t    cycles = cycles_of(&lookup, direction, &speed);
        outcome.checksum = outcome.checksum * 31u + speed;
        outcome.sum += cycles;
        if (cycles > outcome.most) {
            outcome.most = cycles;
            outcome.worst = direction;
        }
    }
    tell(DIRECTIONS);
    tell(outcome.most);
    tell(outcome.sum / DIRECTIONS);
    tell((uint32_t)labs(outcome.worst.dx));
    tell((uint32_t)labs(outcome.worst.dy));
    tell((uint32_t)labs(outcome.worst.dz));
    tell(outcome.checksum);
    UDR0 = '\n';
    cli();
    sleep_mode();
    return 0;
}
