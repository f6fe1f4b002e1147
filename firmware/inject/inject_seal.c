#include "inject/inject_seal.h"

#include <stddef.h>
#include <string.h>

#define NUMBER_OFFSET  5u
#define COMMAND_OFFSET 9u
#define COMMAND_BYTES  7u /* all but the CRC */
#define SHOT_OFFSET    16u
#define SEALED_BYTES   26u
#define DRAWN_BYTES    12u /* another length, lest a challenge is a seal of something */

static void put(uint8_t *bytes, uint64_t value, uint8_t count)
{
    for (uint8_t i = 0u; i < count; ++i) {
        bytes[i] = (uint8_t)(value >> (8u * i));
    }
}

void inject_seal_begin(inject_seal_t *seal, const uint8_t key[INJECT_KEY_BYTES], uint32_t start)
{
    *seal = (inject_seal_t){.start = start, .has_key = true};
    memcpy(seal->key, key, INJECT_KEY_BYTES);
}

void inject_seal_draw(inject_seal_t *seal, uint32_t entropy)
{
    uint8_t drawn[DRAWN_BYTES];
    if (seal->has_challenge) {
        return;
    }
    put(&drawn[0], seal->start, 4u);
    put(&drawn[4], entropy, 4u);
    put(&drawn[8], seal->drawn, 4u);
    put(seal->challenge, inject_siphash_sum(seal->key, drawn, DRAWN_BYTES), INJECT_SEAL_BYTES);
    seal->has_challenge = true;
    ++seal->drawn;
}

static void put_shot(uint8_t *bytes, const inject_shot_t *shot)
{
    bytes[0] = shot->line;
    bytes[1] = shot->level;
    put(&bytes[2], shot->count, 2u);
    put(&bytes[4], shot->width_us, 3u);
    put(&bytes[7], shot->period_us, 3u);
}

/* How long it takes says nothing about the place of a wrong byte. */
static bool is_given(const inject_seal_t *seal, const uint8_t *right)
{
    uint8_t differing = 0u;
    for (uint8_t i = 0u; i < INJECT_SEAL_BYTES; ++i) {
        differing |= (uint8_t)(right[i] ^ seal->given[i]);
    }
    return differing == 0u;
}

static void seal_over(const inject_seal_t *seal, const inject_command_t *command,
                      const inject_shot_t *shot, uint8_t right[INJECT_SEAL_BYTES])
{
    uint8_t sealed[SEALED_BYTES] = {0u};
    uint8_t frame[INJECT_FRAME_BYTES];
    inject_frame_put_command(command, frame);
    memcpy(&sealed[COMMAND_OFFSET], frame, COMMAND_BYTES);
    memcpy(sealed, shot != NULL ? seal->session : seal->challenge, INJECT_SEAL_BYTES);
    if (shot != NULL) {
        put(&sealed[NUMBER_OFFSET], seal->number, 4u);
        put_shot(&sealed[SHOT_OFFSET], shot);
    }
    put(right, inject_siphash_sum(seal->key, sealed, SEALED_BYTES), INJECT_SEAL_BYTES);
}

static void open_session(inject_seal_t *seal)
{
    memcpy(seal->session, seal->challenge, INJECT_SEAL_BYTES);
    seal->has_challenge = false;
    seal->number = 1u;
}

bool inject_seal_take(inject_seal_t *seal, const inject_command_t *command,
                      const inject_shot_t *shot)
{
    uint8_t right[INJECT_SEAL_BYTES];
    seal_over(seal, command, shot, right);
    seal->has_given = false;
    if (!is_given(seal, right)) {
        return false;
    }
    if (shot == NULL) {
        open_session(seal);
    } else {
        ++seal->number;
    }
    return true;
}
