/* The PLC's scans: SysTick, which hardware reloads, so that a late scan makes no later one. */
#include "board.h"
#include "disturbance.h"
#include "drivers.h"
#include "rp2040.h"

#define SYSTICK_SHIFT 24u /* of its priority in SHPR3 */

void scan_start(uint16_t period_us)
{
    SCB_SHPR3 = (uint32_t)PRIORITY_SCAN << (SYSTICK_SHIFT + PRIORITY_SHIFT);
    SYST_RVR = period_us * BOARD_CORE_MHZ - 1u;
    SYST_CVR = 0u;
    SYST_CSR = SYST_RUN;
}

void scan_interrupt(void)
{
    board_on_scan();
    disturbance_in_scan();
}
