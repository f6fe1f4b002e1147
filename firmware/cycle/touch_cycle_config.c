#include <float.h>

#include "cycle/touch_cycle.h"

#define POSITION_MAX_COUNTS 0x0FFFFFFF /* sums of a few positions cannot overflow */

static bool is_position(int32_t counts)
{
    return counts >= -POSITION_MAX_COUNTS && counts <= POSITION_MAX_COUNTS;
}

static bool is_distance(int32_t counts)
{
    return counts > 0 && is_position(counts);
}

static bool is_feed(double mm_min)
{
    return mm_min > 0.0 && mm_min <= DBL_MAX;
}

bool touch_cycle_config_is_sound(const touch_config_t *config, int32_t start_counts)
{
    bool first = is_position(start_counts) && is_position(config->approach_counts) &&
                 config->approach_counts != 0 && is_distance(config->overtravel_counts) &&
                 is_feed(config->feed_mm_min);
    bool second = is_distance(config->back_off_counts) && is_feed(config->measure_feed_mm_min);
    return first && (second || !config->two_touches);
}
