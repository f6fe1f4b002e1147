#include "inject/inject_siphash.h"

#define WORD_BYTES       8u
#define WORD_ROUNDS      2u
#define LAST_ROUNDS      4u
#define LENGTH_SHIFT     56u
#define LAST_ROUNDS_MARK 0xFFu

static uint64_t get(const uint8_t *bytes, uint8_t count)
{
    uint64_t value = 0u;
    while (count != 0u) {
        --count;
        value = value << 8 | bytes[count];
    }
    return value;
}

static uint64_t rotated(uint64_t value, uint8_t bits)
{
    return value << bits | value >> (64u - bits);
}

static void mix(uint64_t v[4], uint8_t rounds)
{
    for (; rounds != 0u; --rounds) {
        v[0] += v[1];
        v[2] += v[3];
        v[1] = rotated(v[1], 13u) ^ v[0];
        v[3] = rotated(v[3], 16u) ^ v[2];
        v[0] = rotated(v[0], 32u);
        v[2] += v[1];
        v[0] += v[3];
        v[1] = rotated(v[1], 17u) ^ v[2];
        v[3] = rotated(v[3], 21u) ^ v[0];
        v[2] = rotated(v[2], 32u);
    }
}

static void take(uint64_t v[4], uint64_t word)
{
    v[3] ^= word;
    mix(v, WORD_ROUNDS);
    v[0] ^= word;
}

uint64_t inject_siphash_sum(const uint8_t key[INJECT_SIPHASH_KEY_BYTES], const uint8_t *bytes,
                            uint8_t length)
{
    uint64_t low = get(key, WORD_BYTES);
    uint64_t high = get(&key[WORD_BYTES], WORD_BYTES);
    uint64_t v[4] = {/* "somepseudorandomlygeneratedbytes" */
                     low ^ UINT64_C(0x736F6D6570736575), high ^ UINT64_C(0x646F72616E646F6D),
                     low ^ UINT64_C(0x6C7967656E657261), high ^ UINT64_C(0x7465646279746573)};
    uint64_t ending = (uint64_t)length << LENGTH_SHIFT;
    for (; length >= WORD_BYTES; length = (uint8_t)(length - WORD_BYTES)) {
        take(v, get(bytes, WORD_BYTES));
        bytes += WORD_BYTES;
    }
    take(v, ending | get(bytes, length));
    v[2] ^= LAST_ROUNDS_MARK;
    mix(v, LAST_ROUNDS);
    return v[0] ^ v[1] ^ v[2] ^ v[3];
}
