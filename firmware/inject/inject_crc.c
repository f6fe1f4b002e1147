#include "inject/inject_crc.h"

#define POLYNOMIAL 0x2Fu

uint8_t inject_crc_update(uint8_t crc, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; ++i) {
        crc = (uint8_t)(crc ^ bytes[i]);
        for (uint8_t bit = 0; bit < 8u; ++bit) {
            crc = (uint8_t)((crc & 0x80u) != 0u ? (uint32_t)crc << 1 ^ POLYNOMIAL
                                                : (uint32_t)crc << 1);
        }
    }
    return crc;
}

uint8_t inject_crc_finish(uint8_t crc)
{
    return (uint8_t)~crc;
}
