/*
 * CRC-8/AUTOSAR: polynomial 0x2F, start 0xFF, inverted at the end; no table. It sees every error of
 * three bits in up to 119 bits.
 */
#ifndef INJECT_CRC_H
#define INJECT_CRC_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define INJECT_CRC_START 0xFFu

/* Carry the sum `crc` on over `length` bytes. Any context. */
uint8_t inject_crc_update(uint8_t crc, const uint8_t *bytes, size_t length);

/* The sum as it is sent: 0xDF for the ASCII digits 1 to 9. Any context. */
uint8_t inject_crc_finish(uint8_t crc);

#ifdef __cplusplus
}
#endif

#endif
