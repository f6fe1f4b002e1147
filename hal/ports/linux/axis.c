#include "axis.h"

#include <math.h>
#include <stdbool.h>

#include "clock.h"
#include "hal_axis.h"

#define AXIS 0u

static double   speed_counts_per_s;
static int32_t  origin_counts;
static uint64_t captured_ns;
static bool     is_captured;

void axis_run(double counts_per_s)
{
    origin_counts = 0;
    speed_counts_per_s = counts_per_s;
}

void axis_place(int32_t position_counts)
{
    origin_counts = position_counts;
    speed_counts_per_s = 0.0;
}

void axis_capture(uint64_t monotonic_ns)
{
    captured_ns = monotonic_ns;
    is_captured = true;
}

void axis_follow(void)
{
    is_captured = false;
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    if (axis != AXIS) {
        return 0;
    }
    uint64_t at_ns = is_captured ? captured_ns : clock_now_ns();
    double   travel_counts = speed_counts_per_s * ((double)at_ns / CLOCK_NS_PER_S);
    uint32_t position = (uint32_t)origin_counts + (uint32_t)(uint64_t)llrint(travel_counts);
    return (int32_t)position;
}
