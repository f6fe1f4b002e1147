/*
 * What both ways to watch the trigger line share: its pin and polarity. edge_capture.c stamps the
 * edge in hardware, edge_pin_change.c in the interrupt; a program links one of the two.
 */
#ifndef ATMEGA328P_EDGE_LINE_H
#define ATMEGA328P_EDGE_LINE_H

#include <stdbool.h>

#include "hal_edge.h"

/* HAL_OK, HAL_ERR_CHANNEL, or HAL_ERR_CONFIG: this board has no filter. Task. */
int edge_line_check(const hal_edge_config_t *config);

/* True: deflected while low. Task, the interrupt of the line masked. */
void edge_line_set_polarity(bool active_low);

/* The pin behind the polarity. Any context. */
bool edge_line_is_deflected(void);

#endif
