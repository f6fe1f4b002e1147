/*
 * One loop dispatches everything: an edge or a scan runs to its end before the next one, and the
 * task runs between them. So there is nothing to mask, only the compiler to be held back.
 */
#include <stdatomic.h>

#include "hal_critical.h"

hal_critical_state_t hal_critical_enter(void)
{
    atomic_signal_fence(memory_order_seq_cst);
    return 0u;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    (void)saved;
    atomic_signal_fence(memory_order_seq_cst);
}
