#include "transmission/point_frame.h"

#define TALLY 255u

static void put(uint8_t *bytes, uint8_t count, uint64_t value)
{
    for (uint8_t i = 0u; i < count; ++i) {
        bytes[i] = (uint8_t)value;
        value >>= 8;
    }
}

void point_frame_of_point(uint8_t frame[POINT_FRAME_BYTES], uint32_t part,
                          const transmission_point_t *point)
{
    frame[0] = (uint8_t)(part % TALLY);
    put(&frame[1], 2u, (uint32_t)point->line);
    put(&frame[3], 5u, (uint64_t)point->delta_nas >> 8);
}

void point_frame_of_tally(uint8_t frame[POINT_FRAME_BYTES], const pulse_intake_t *intake)
{
    pulse_counters_t input = transmission_counters(&intake->core, TRANSMISSION_INPUT);
    pulse_counters_t output = transmission_counters(&intake->core, TRANSMISSION_OUTPUT);
    frame[0] = TALLY;
    put(&frame[1], 2u, input.missing + output.missing);
    put(&frame[3], 2u, input.extra + output.extra);
    put(&frame[5], 1u, input.slips + output.slips);
    put(&frame[6], 2u, intake->lost);
}
