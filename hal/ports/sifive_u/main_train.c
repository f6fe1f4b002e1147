/* Trains of edges: PWM0's first compare interrupt is wired to the trigger pin by the emulator. */
#include "drivers.h"
#include "fu540.h"
#include "train.h"

/* The compare of 1 is reached within an instruction. Interrupt. */
void board_on_scan(void)
{
    if (train_edge_is_due()) {
        PWM_CFG(PWM0) = 0u;
        PWM_COUNT(PWM0) = 0u;
        PWM_CMP(PWM0, 0u) = 1u;
        PWM_CFG(PWM0) = PWM_RUN_ONCE;
    }
    train_scan();
}

int main(void)
{
    return train_main();
}
