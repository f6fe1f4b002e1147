/* The position counter of an axis. */
#ifndef HAL_AXIS_H
#define HAL_AXIS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Position of the axis now, in counts of its resolution, without tearing. Any context; called from
 * the edge interrupt, so it has to be short. An unknown axis reads 0.
 */
int32_t hal_axis_position_counts(uint8_t axis);

#ifdef __cplusplus
}
#endif

#endif
