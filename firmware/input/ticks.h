/*
 * Arithmetic on a clock that wraps: differences are taken at 32 bits and nothing is ever compared
 * directly. A time has to be looked at within 2^30 ticks after its end, lest it look new again.
 */
#ifndef INPUT_TICKS_H
#define INPUT_TICKS_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TICKS_NEVER        UINT32_MAX  /* as a duration: no time is set */
#define TICKS_MAX_DURATION 0x7FFFFFFFu /* longer ones are cut to this */
#define TICKS_LOOK         0x40000000u /* a time that is set is looked at this often at least */
#define TICKS_BEFORE       0xC0000000u /* an elapsed time this long is a reading from before */

/* Ticks from `since` to `now`, right across the wrap. */
static inline uint32_t ticks_elapsed(uint32_t now, uint32_t since)
{
    return (uint32_t)(now - since);
}

/*
 * Ticks that are left of `duration` begun at `since`; 0 once it is over. All of it is left if `now`
 * was read just before `since`: an interrupt may set a time between a task's reading and its use.
 */
static inline uint32_t ticks_left(uint32_t now, uint32_t since, uint32_t duration)
{
    uint32_t elapsed = ticks_elapsed(now, since);
    if (elapsed >= TICKS_BEFORE) {
        return duration;
    }
    return elapsed < duration ? duration - elapsed : 0u;
}

/*
 * Ticks in `us` microseconds, rounded up, TICKS_MAX_DURATION at most. `tick_ps` is at least 1.
 * Task.
 */
static inline uint32_t ticks_from_us(uint32_t us, uint32_t tick_ps)
{
    uint64_t ticks = ((uint64_t)us * 1000000u + tick_ps - 1u) / tick_ps;
    return ticks < TICKS_MAX_DURATION ? (uint32_t)ticks : TICKS_MAX_DURATION;
}

#ifdef __cplusplus
}
#endif

#endif
