/*
 * SipHash-2-4 (Aumasson, Bernstein, "SipHash: a fast short-input PRF", 2012): a sum of few bytes
 * that nobody can foretell without the key. No table, for RAM is dear on an AVR.
 */
#ifndef INJECT_SIPHASH_H
#define INJECT_SIPHASH_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define INJECT_SIPHASH_KEY_BYTES 16u

/* The sum of `length` bytes under the key; as numbers, both are little-endian. Task. */
uint64_t inject_siphash_sum(const uint8_t key[INJECT_SIPHASH_KEY_BYTES], const uint8_t *bytes,
                            uint8_t length);

#ifdef __cplusplus
}
#endif

#endif
