/*
 * CRC-16 with the CCITT polynomial 0x1021, most significant bit first, no table (RAM is dear on
 * an AVR).
 */
#ifndef REPORT_LATCH_CRC_H
#define REPORT_LATCH_CRC_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LATCH_CRC_START 0xFFFFu /* "CRC-16/CCITT-FALSE": 0x29B1 for the ASCII digits 1 to 9 */

/* Carry the sum `crc` on over `length` bytes. Any context. */
uint16_t latch_crc_update(uint16_t crc, const uint8_t *bytes, size_t length);

#ifdef __cplusplus
}
#endif

#endif
