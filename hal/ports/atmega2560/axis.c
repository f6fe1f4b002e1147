#include "axis.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "hal_axis.h"
#include "hal_critical.h"

#define AXIS          0u
#define STEP          (1u << PE4)
#define DIRECTION     (1u << PE5) /* high: towards the surface */
#define RISING_EDGE_4 ((1u << ISC41) | (1u << ISC40))

static volatile int32_t position;

ISR(INT4_vect)
{
    position += (PINE & DIRECTION) != 0u ? 1 : -1;
}

void axis_start(void)
{
    DDRE &= (uint8_t)~(STEP | DIRECTION);
    EICRB |= RISING_EDGE_4;
    EIFR = 1u << INTF4;
    EIMSK |= 1u << INT4;
}

void axis_place(int32_t position_counts)
{
    hal_critical_state_t saved = hal_critical_enter();
    position = position_counts;
    hal_critical_exit(saved);
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    if (axis != AXIS) {
        return 0;
    }
    hal_critical_state_t saved = hal_critical_enter();
    int32_t              now = position;
    hal_critical_exit(saved);
    return now;
}
