/*
 * Seals of commands, for benches that share their bus: SipHash-2-4 under a key that host and
 * injector share, cut to 40 bits. It runs over 26 bytes, numbers little-endian:
 *
 *   0 … 4     ARM: the challenge that the injector has given; TRIGGER: that of the session's ARM
 *   5 … 8     ARM: 0; TRIGGER: its number in the session, from 1 on, of those that were obeyed
 *   9 … 15    bytes 0 to 6 of the command
 *   16 … 25   ARM: zeros; TRIGGER: what it plays: line, level, count (2 bytes), width_us, period_us
 *             (3 bytes each)
 *
 * A challenge opens one session, so what was sealed for another one, or for another place in this
 * one, never fits.
 */
#ifndef INJECT_SEAL_H
#define INJECT_SEAL_H

#include <stdbool.h>
#include <stdint.h>

#include "inject/inject_frame.h"
#include "inject/inject_siphash.h"

#ifdef __cplusplus
extern "C" {
#endif

#define INJECT_KEY_BYTES INJECT_SIPHASH_KEY_BYTES

/* All zeros: no key. */
typedef struct {
    uint8_t  key[INJECT_KEY_BYTES];
    uint8_t  challenge[INJECT_SEAL_BYTES]; /* for the next ARM, if has_challenge */
    uint8_t  session[INJECT_SEAL_BYTES];   /* the challenge that the last ARM has spent */
    uint8_t  given[INJECT_SEAL_BYTES];     /* by the last SEAL, if has_given */
    uint32_t start;                        /* differs from start to start */
    uint32_t drawn;                        /* challenges since the start */
    uint32_t number;                       /* of the session's next TRIGGER */
    bool     has_key;
    bool     has_challenge;
    bool     has_given;
} inject_seal_t;

/* Begin to ask for seals. `start` is to differ from start to start. */
void inject_seal_begin(inject_seal_t *seal, const uint8_t key[INJECT_KEY_BYTES], uint32_t start);

/* Have a challenge; one that is not spent stays. `entropy` makes it harder to guess. Task. */
void inject_seal_draw(inject_seal_t *seal, uint32_t entropy);

/*
 * Whether the seal that was given last fits the ARM (`shot` is NULL), which then opens a session,
 * or the TRIGGER, which plays `shot` and then is the session's next one. Right or wrong, the seal
 * is spent. Only with a key, a seal and (ARM) a challenge, and as the last check of all. Task.
 */
bool inject_seal_take(inject_seal_t *seal, const inject_command_t *command,
                      const inject_shot_t *shot);

#ifdef __cplusplus
}
#endif

#endif
