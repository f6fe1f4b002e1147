/*
 * The device clock: SysTick, which counts 24 bits down, and its wraps. The general-purpose timers
 * have 32 bits, but the emulator does not let them be read.
 */
#include "board.h"
#include "cortex_m.h"
#include "disturbance.h"
#include "drivers.h"
#include "hal_clock.h"
#include "hal_critical.h"

#define COUNTER_BITS 24u
#define COUNTER_MAX  0xFFFFFFu
#define CORE_TICK_PS 20000u

/* A coarser clock drops the lowest bits of the counter. */
#define TICK_SHIFT DISTURBANCE_PRESCALER_SHIFT

static volatile uint32_t clock_wraps;

void clock_start(uint32_t ticks)
{
    uint32_t low = ticks << TICK_SHIFT & COUNTER_MAX;

    SYST_CSR = 0u;
    clock_wraps = ticks >> (COUNTER_BITS - TICK_SHIFT);
    SYST_RVR = low == 0u ? COUNTER_MAX : COUNTER_MAX + 1u - low;
    SYST_CVR = 0u; /* whatever is written clears it, and the first tick loads it */
    SYST_CSR = SYST_RUN;
    while (SYST_CVR == 0u) {
    }
    SYST_RVR = COUNTER_MAX;
}

/*
 * Of the highest priority, like the trigger line: else an edge could read the clock after the
 * request was taken back and before the wrap is counted.
 */
void clock_on_wrap(void)
{
    ++clock_wraps;
}

/*
 * The wrap is requested when the counter reaches 0, one tick before it is loaded again; so 0 is the
 * first count of the new period. The request is looked at after the counter: if there is none, the
 * counter was read before the wrap.
 */
uint32_t hal_clock_now_ticks(void)
{
    hal_critical_state_t saved = hal_critical_enter();
    uint32_t             down = SYST_CVR;
    uint32_t             wraps = clock_wraps;
    if ((SCB_ICSR & ICSR_PENDSTSET) != 0u) {
        down = SYST_CVR;
        ++wraps;
    }
    hal_critical_exit(saved);
    uint32_t up = (0u - down) & COUNTER_MAX;
    return wraps << (COUNTER_BITS - TICK_SHIFT) | up >> TICK_SHIFT;
}

uint32_t hal_clock_tick_ps(void)
{
    return CORE_TICK_PS << TICK_SHIFT;
}
