/* The PLC's scans: each is due a period after the one before, so that a late one makes no later
 * one. */
#include "disturbance.h"
#include "drivers.h"
#include "riscv.h"

/* Ticks of CLINT's timer are µs. A rig waits for the period. */
static uint64_t          scan_due_us;
static volatile uint32_t scan_period_us;

/* In between the timer must not be due. */
static void wait_for_next(void)
{
    scan_due_us += scan_period_us;
    CLINT_MTIMECMP_HI = UINT32_MAX;
    CLINT_MTIMECMP = (uint32_t)scan_due_us;
    CLINT_MTIMECMP_HI = (uint32_t)(scan_due_us >> 32);
}

void scan_start(uint16_t period_us)
{
    uint32_t high;
    do {
        high = CLINT_MTIME_HI;
        scan_due_us = (uint64_t)high << 32 | CLINT_MTIME;
    } while (CLINT_MTIME_HI != high);
    scan_period_us = period_us;
    wait_for_next();
    CSR_SET(mie, MIE_TIMER);
}

void scan_interrupt(void)
{
    wait_for_next();
    board_on_scan();
    disturbance_in_scan();
}
