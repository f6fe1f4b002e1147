/*
 * The axis: a count of 0.1 µm that goes with the core's cycles. The chip has no counter for pulses;
 * a board with a scale would read that here.
 */
#include "board.h"
#include "drivers.h"
#include "hal_axis.h"
#include "hal_critical.h"
#include "riscv.h"

#define AXIS 0u

/*
 * Counts a tick of 8 cycles, in parts of 2^38: 10,000 counts a mm, over 60 s of 125 MHz. At 3000
 * mm/min the product below has room for 137 s, a way of 6 m.
 */
#define RATE_SHIFT             38u
#define RATE_AT_1_MM_PER_MIN_N (10000ull << RATE_SHIFT)
#define RATE_AT_1_MM_PER_MIN_D (60ull * 1000000ull * BOARD_TICKS_PER_US)

static int32_t  axis_rest_counts;
static uint32_t axis_rate;

/* Nothing in the firmware needs to tell it; a rig reads it in memory. */
static uint64_t axis_started_cycles;

static void set(int32_t rest_counts, uint32_t rate)
{
    hal_critical_state_t saved = hal_critical_enter();
    axis_rest_counts = rest_counts;
    axis_rate = rate;
    axis_started_cycles = riscv_cycles();
    hal_critical_exit(saved);
}

void axis_place(int32_t position_counts)
{
    set(position_counts, 0u);
}

void axis_run(uint32_t feed_mm_per_min)
{
    uint64_t rate = feed_mm_per_min * RATE_AT_1_MM_PER_MIN_N / RATE_AT_1_MM_PER_MIN_D;
    set(0, (uint32_t)rate);
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    if (axis != AXIS) {
        return 0;
    }
    uint64_t ticks = (riscv_cycles() - axis_started_cycles) >> BOARD_CYCLE_SHIFT;
    return axis_rest_counts + (int32_t)(ticks * axis_rate >> RATE_SHIFT);
}
