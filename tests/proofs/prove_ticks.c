/* Arithmetic on a clock that wraps, for every time and duration. */
/* MUTANT: firmware/input/ticks.h: duration - elapsed : 0u => duration - elapsed : 1u */
/* MUTANT: firmware/input/ticks.h: return elapsed < duration => return now < since + duration */
/* MUTANT: firmware/input/ticks.h: (uint32_t)(now - since) => (uint32_t)(now > since ? now - since :
 * 0u) */
/* MUTANT: firmware/input/ticks.h: ticks < TICKS_MAX_DURATION => ticks <= UINT32_MAX */
#include "any.h"
#include "input/ticks.h"

static void prove_left(void)
{
    uint32_t since = nondet_u32();
    uint32_t elapsed = nondet_u32();
    uint32_t duration = nondet_u32();
    ASSUME(duration <= TICKS_MAX_DURATION);
    uint32_t left = ticks_left(since + elapsed, since, duration);

    PROVE(ticks_elapsed(since + elapsed, since) == elapsed);
    PROVE(IMPLIES(elapsed >= TICKS_BEFORE, left == duration));
    PROVE(IMPLIES(elapsed < TICKS_BEFORE && elapsed < duration, left == duration - elapsed));
    PROVE(IMPLIES(elapsed < TICKS_BEFORE && elapsed >= duration, left == 0u));
}

/* What is cut, and what is not: that it is rounded up is for the unit tests, division being dear.
 */
static void prove_from_us(void)
{
    uint32_t us = nondet_u32();
    uint32_t tick_ps = nondet_u32();
    ASSUME(tick_ps != 0u);

    PROVE(ticks_from_us(us, tick_ps) <= TICKS_MAX_DURATION);
    PROVE(ticks_from_us(0u, tick_ps) == 0u || tick_ps == 0u);
}

int main(void)
{
    prove_left();
    prove_from_us();
    return 0;
}
