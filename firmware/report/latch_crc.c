#include "report/latch_crc.h"

/*
 * Eight steps of the shift register at once: every shift is a constant, so an 8-bit chip needs
 * no loop.
 */
static uint16_t update_byte(uint16_t crc, uint8_t byte)
{
    uint8_t top = (uint8_t)((crc >> 8) ^ byte);
    top = (uint8_t)(top ^ (top >> 4));
    return (uint16_t)((uint32_t)crc << 8 ^ (uint32_t)top << 12 ^ (uint32_t)top << 5 ^ top);
}

uint16_t latch_crc_update(uint16_t crc, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; ++i) {
        crc = update_byte(crc, bytes[i]);
    }
    return crc;
}
