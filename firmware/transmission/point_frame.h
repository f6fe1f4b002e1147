/*
 * What a board reports of a transmission error, in frames of eight bytes: each point, and on demand
 * what was found in the trains. Little-endian.
 *
 *   byte    point                                           tally
 *   0       part it belongs to, modulo 255                  255
 *   1 - 2   line, modulo 2^16                               missing pulses, modulo 2^16
 *   3 - 4   delta, in 256 nanoarcseconds, modulo 2^40       extra pulses, modulo 2^16
 *   5       (39 degrees either way)                         slips, modulo 2^8
 *   6 - 7                                                   pulses lost by the port, modulo 2^16
 */
#ifndef TRANSMISSION_POINT_FRAME_H
#define TRANSMISSION_POINT_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "transmission/pulse_intake.h"

#ifdef __cplusplus
extern "C" {
#endif

#define POINT_FRAME_BYTES 8u

void point_frame_of_point(uint8_t frame[POINT_FRAME_BYTES], uint32_t part,
                          const transmission_point_t *point);

void point_frame_of_tally(uint8_t frame[POINT_FRAME_BYTES], const pulse_intake_t *intake);

#ifdef __cplusplus
}
#endif

#endif
