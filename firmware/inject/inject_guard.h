/*
 * Decides which command frames are obeyed. A frame that is damaged, out of range, repeated, stale,
 * unarmed or without the right token is counted and answered, and changes nothing else.
 *
 * Commands are in order if the counter steps on by 1 to 127. A greater step than 1 means that
 * frames were lost: then PULSE and TRAIN have to be given again, since one of the lost may have
 * changed them. ASK stands outside: it is always answered, from which a host that starts learns
 * the counter.
 *
 * With a key, ARM and TRIGGER have to follow a SEAL that fits (inject_seal.h). DISARM needs none:
 * whoever wants to stop, may.
 */
#ifndef INJECT_GUARD_H
#define INJECT_GUARD_H

#include <stdbool.h>
#include <stdint.h>

#include "inject/inject_frame.h"
#include "inject/inject_seal.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    INJECT_OBEYED = 0,
    INJECT_DAMAGED,      /* CRC wrong, or not eight bytes */
    INJECT_REPEATED,     /* the counter of the last command in order */
    INJECT_STALE,        /* older than that */
    INJECT_OUT_OF_RANGE, /* unknown kind, a figure out of range, or pulses that overlap */
    INJECT_UNARMED,      /* never armed, disarmed, or the token has expired */
    INJECT_WRONG_TOKEN,  /* another one than the last given, or a spent one; ARM after too many */
    INJECT_INCOMPLETE,   /* TRIGGER without PULSE and TRAIN since arming or since a loss */
    INJECT_BUSY,         /* TRIGGER while a train plays */
    INJECT_FORGED,       /* with a key: ARM or TRIGGER without the seal that fits */
    INJECT_VERDICTS
} inject_verdict_t;

typedef enum { INJECT_IDLE = 0, INJECT_ARMED = 1, INJECT_RUNNING = 2 } inject_state_t;

/* After so many wrong tokens and wrong seals the token is dropped, and none is given for so long.
 */
#define INJECT_WRONG_TOKENS_MAX 3u
#define INJECT_LOCKED_MS        10000u

/* Begin with inject_guard_begin(). Counters stop at their maximum. */
typedef struct {
    uint16_t      verdicts[INJECT_VERDICTS]; /* frames by verdict */
    uint16_t      lost_commands;             /* gaps of the counter */
    uint16_t      edges;                     /* driven so far, modulo 2^16: the port counts them */
    uint16_t      dropped_frames; /* reports that the bus did not take: the port counts them */
    uint16_t      token;          /* 0: none */
    uint16_t      last_token;     /* the last that was given, expired or not */
    uint32_t      random;         /* where tokens come from; never 0 */
    uint64_t      armed_ms;       /* when the token was given */
    uint64_t      wrong_ms;       /* when the last wrong token or seal came */
    inject_shot_t shot;           /* as PULSE and TRAIN have set it */
    uint16_t      valid_ms;
    uint8_t       last_counter; /* of the last command in order */
    uint8_t       lines;        /* how many lines there are to drive */
    uint8_t       wrong_tokens; /* since the last pause of INJECT_LOCKED_MS */
    bool          has_pulse;
    bool          has_train;
    bool          is_running; /* a train plays: the port says so */
    inject_seal_t seal;
} inject_guard_t;

/* What came of a frame. */
typedef struct {
    inject_verdict_t verdict;
    uint8_t          page; /* to answer with: 0, or the page that ASK wants */
    bool             has_shot;
    bool             has_stop; /* stop a train that plays, and put the line to rest */
    inject_shot_t    shot;     /* to be played, if has_shot */
} inject_order_t;

/*
 * Start unarmed. `seed` should differ from start to start; `lines` is 1 … INJECT_LINES. `now_ms`
 * below is a clock that never wraps, so that no token lives again.
 */
void inject_guard_begin(inject_guard_t *guard, uint32_t seed, uint8_t lines);

/*
 * From now on ask for seals under this key, which is copied. Directly after inject_guard_begin(),
 * whose seed then has to differ from start to start, lest a recorded session opens again: a board
 * without a generator of random numbers counts its starts in EEPROM, from 1 on (0 is taken for 1).
 * Task.
 */
void inject_guard_set_key(inject_guard_t *guard, const uint8_t key[INJECT_KEY_BYTES]);

/*
 * Make the next token as hard to guess as `entropy`: a port with a generator of random numbers
 * calls this before every frame. Task.
 */
void inject_guard_stir(inject_guard_t *guard, uint32_t entropy);

/* Judge one frame with the command id, `length` bytes long; say what is to be done. Task. */
inject_order_t inject_guard_take(inject_guard_t *guard, const uint8_t *frame, uint8_t length,
                                 uint64_t now_ms);

/* Count one more, up to the maximum; for the counters that the port keeps, too. Any context. */
void inject_guard_count(uint16_t *counter, uint16_t by);

/* The state as it is to be reported; lets a token expire. Task. */
inject_state_t inject_guard_state(inject_guard_t *guard, uint64_t now_ms);

/* Write page `page` (0: the answer with `verdict`) as status frame number `counter`. Task. */
void inject_guard_report(inject_guard_t *guard, uint8_t page, inject_verdict_t verdict,
                         uint8_t counter, uint64_t now_ms, uint8_t frame[INJECT_FRAME_BYTES]);

#ifdef __cplusplus
}
#endif

#endif
