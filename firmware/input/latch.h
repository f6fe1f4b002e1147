/*
 * One latching input: keeps the first edge of a touch, then confirms or rejects it.
 *
 * The first edge is what counts. Its time and position are kept at once; debouncing afterwards only
 * decides whether it was a touch, and never moves it. The skip input feeds it from the edge
 * interrupt, the PLC task from its scan.
 */
#ifndef INPUT_LATCH_H
#define INPUT_LATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "input/latch_record.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    LATCH_DISARMED,   /* edges are counted as unarmed */
    LATCH_ARMED,      /* waits for the first edge */
    LATCH_CONFIRMING, /* an edge is kept; the level decides what it was */
    LATCH_HOLDING,    /* confirmed; further edges are bounces until the hold-off is over */
    LATCH_TOUCHED     /* disarmed, and an edge has come since the last poll: the level may be old */
} latch_phase_t;

/*
 * Durations are at most TICKS_MAX_DURATION (input/ticks.h). Poll more often than confirm_ticks: a
 * glitch and a touch between two polls look like a touch that bounces, so they are one, latched at
 * the glitch and flagged LATCH_FLAG_BOUNCED.
 */
typedef struct {
    bool     repeated;      /* after a touch: true arms again, false disarms */
    uint32_t confirm_ticks; /* the level rests this long to confirm or reject; 0 confirms at once */
    uint32_t holdoff_ticks; /* from the first edge on; edges within it belong to the touch */
} latch_config_t;

/* Events since latch_init(). Each count wraps at 2^16. */
typedef struct {
    uint16_t bounces;  /* further edges of a touch */
    uint16_t glitches; /* edges that were rejected */
    uint16_t overruns; /* confirmed latches that were lost, because nobody took them in time */
    uint16_t unarmed;  /* edges that came in while disarmed, or waited when it was disarmed */
} latch_counters_t;

/* An edge as it is kept: what the record will say of it and its channel does not know. */
typedef struct {
    uint32_t ticks;
    int32_t  position_counts;
    uint8_t  flags; /* LATCH_FLAG_* */
} latch_edge_t;

/*
 * Owned by the caller; the fields are for this module. Interrupt and task share it under
 * hal_critical.
 */
typedef struct {
    latch_config_t   config;
    latch_counters_t counters;
    latch_edge_t     kept;          /* the first edge of the present touch */
    latch_edge_t     ready;         /* a confirmed touch, while has_ready */
    uint32_t         changed_ticks; /* when the level was last seen to change */
    uint8_t          phase;         /* latch_phase_t, in a byte */
    uint8_t          channel;
    bool             level; /* deflected, as last seen */
    bool             has_ready;
    bool             has_unarmed; /* not told yet by latch_take_unarmed() */
} latch_t;

/*
 * Before first use. channel: 0 … LATCH_CHANNEL_MAX; flags: LATCH_FLAG_PLC or 0, copied into every
 * record. Task, edges not yet delivered.
 */
void latch_init(latch_t *latch, uint8_t channel, uint8_t flags);

/*
 * Wait for the next edge. A record that nobody took is lost: counted as an overrun, and flagged in
 * the next one. An edge that waits to be confirmed is counted as unarmed. Task.
 */
void latch_arm(latch_t *latch, const latch_config_t *config);

/*
 * The same if the probe is free, as last polled, with no edge since and none that waits to be
 * confirmed; false, and nothing is changed, if not. An edge that comes too early for the latch is
 * thus never lost to it. Task.
 */
bool latch_arm_free(latch_t *latch, const latch_config_t *config);

/*
 * Latch nothing more; a confirmed record can still be taken. An edge that waits to be confirmed is
 * counted as unarmed. Task.
 */
void latch_disarm(latch_t *latch);

/* The same unless an edge waits to be confirmed; false, and nothing is changed, if one does. Task.
 */
bool latch_disarm_settled(latch_t *latch);

/*
 * An edge into the deflected state, with the clock and the position at that instant. ISR or
 * scan.
 */
void latch_on_edge(latch_t *latch, uint32_t ticks, int32_t position_counts);

/*
 * Tell the level at `now_ticks`; confirms, rejects and ends the hold-off. Task or scan. Has to be
 * called as often as latch_idle_ticks() says, or an old time looks new.
 */
void latch_poll(latch_t *latch, uint32_t now_ticks, bool level);

/* Take the confirmed record. False if there is none. Task. */
bool latch_take(latch_t *latch, latch_record_t *record);

/* A record that was taken was lost on its way: counted, and flagged in the next one. Task. */
void latch_count_lost(latch_t *latch);

/* True if edges were counted as unarmed since latch_init() or the last call. Task. */
bool latch_take_unarmed(latch_t *latch);

/*
 * How long polling can be left out while no edge comes: until an edge that waits can be confirmed,
 * 2^30 ticks at most from an edge on until a poll after the hold-off, else TICKS_NEVER. Task.
 */
uint32_t latch_idle_ticks(const latch_t *latch, uint32_t now_ticks);

/* Level as last polled or latched: true is deflected. Task. */
bool latch_level(const latch_t *latch);

/* True while an edge waits to be confirmed. Task. */
bool latch_is_confirming(const latch_t *latch);

/* A consistent copy of the counters. Task. */
latch_counters_t latch_counters(const latch_t *latch);

#ifdef __cplusplus
}
#endif

#endif
