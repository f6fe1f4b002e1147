/* Trains of edges: timer 3's interrupt output is wired to the trigger pin by the emulator. */
#include "drivers.h"
#include "lm3s6965.h"
#include "train.h"

#define TIMER_LINE 3u

/* The rig has set it up for one shot, which is due a tick later. Interrupt. */
void board_on_scan(void)
{
    if (train_edge_is_due()) {
        TIMER_ICR(TIMER_LINE) = TIMER_A;
        TIMER_CTL(TIMER_LINE) = 0u;
        TIMER_TAILR(TIMER_LINE) = 1u;
        TIMER_CTL(TIMER_LINE) = TIMER_A;
    }
    train_scan();
}

int main(void)
{
    return train_main();
}
