#include "drivers.h"

/* The clocks run: the boot loader has set them. */
void board_start(void)
{
    clock_start(0u);
    edge_start();
    axis_place(0);
    bus_start();
}
