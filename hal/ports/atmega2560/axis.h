/* The axis: steps counted from the motion controller's step line (PE4, INT4) and direction (PE5).
 */
#ifndef ATMEGA2560_AXIS_H
#define ATMEGA2560_AXIS_H

#include <stdint.h>

/* Watch the step line. Task, once. */
void axis_start(void);

/* Call the present position `position_counts`. Task. */
void axis_place(int32_t position_counts);

#endif
