/*
 * A second program for the RP2040: the skip input, and beside it a model of how grblHAL takes its
 * probe in. There the interrupt of the edge sets a flag, an SR latch in software, and the next
 * interrupt of the stepper keeps the position (grblHAL/core, probe.c and stepper.c). Both latch the
 * same edges of the same axis.
 *
 * A byte on the UART says what to do: '1', '2' and '3' let the axis run from 0 at 100, 1000 and
 * 3000 mm/min, '0' stops it. A rig reads in memory what was latched.
 */
#include <stdbool.h>
#include <stdint.h>

#include "board.h"
#include "drivers.h"
#include "hal_axis.h"
#include "hal_clock.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/skip_input.h"
#include "rp2040.h"

#define CHANNEL 0u
#define AXIS    0u

/* Of 5 µm each, 200 a mm. */
#define STEP_US_AT_1_MM_PER_MIN 300000u

/* Every edge is a touch: what a rig injects does not bounce. */
static const latch_config_t LATCH = {.repeated = true, .confirm_ticks = 0u, .holdoff_ticks = 0u};

static const skip_input_config_t SKIP = {
    .edge = {.channel = CHANNEL, .active_low = false, .glitch_filter_us = 0u},
    .axis = AXIS,
};

static const uint32_t FEEDS_MM_PER_MIN[] = {0u, 100u, 1000u, 3000u};
#define FEEDS (sizeof FEEDS_MM_PER_MIN / sizeof *FEEDS_MM_PER_MIN)

static skip_input_t skip;

static volatile int32_t axis_pulses; /* that have begun */
static uint32_t         interrupts_a_step;
static uint32_t         interrupts_to_step; /* 0: the next one begins a pulse */

static volatile bool sr_latch;

/* Of the last touch; a rig reads them in memory, and how many there were. */
static volatile uint32_t skip_ticks;
static volatile int32_t  skip_counts;
static volatile uint32_t skip_touches;
static volatile uint32_t stepper_us; /* since reset */
static volatile int32_t  stepper_counts;
static volatile uint32_t stepper_touches;

/* grblHAL's smoothing (AMASS): the longer a step, the more interrupts it has. */
static uint32_t interrupts_in(uint32_t step_us)
{
    if (step_us < 125u) {
        return 1u;
    }
    if (step_us < 250u) {
        return 2u;
    }
    return step_us < 500u ? 4u : 8u;
}

void axis_place(int32_t position_counts)
{
    PWM_CSR(SLICE_AXIS) = 0u;
    PWM_INTE = 0u;
    PWM_INTR = PWM_SLICE(SLICE_AXIS);
    NVIC_ICPR(IRQ_PWM_WRAP) = NVIC_BIT(IRQ_PWM_WRAP);
    axis_pulses = position_counts;
}

void axis_run(uint32_t feed_mm_per_min)
{
    axis_place(0);
    if (feed_mm_per_min == 0u) {
        return;
    }
    uint32_t step_us = STEP_US_AT_1_MM_PER_MIN / feed_mm_per_min;
    interrupts_a_step = interrupts_in(step_us);
    interrupts_to_step = interrupts_a_step - 1u;
    cortex_m_enable_irq(IRQ_PWM_WRAP, PRIORITY_AXIS);
    PWM_INTE = PWM_SLICE(SLICE_AXIS);
    board_start_slice(SLICE_AXIS, step_us / interrupts_a_step - 1u);
}

/* In grblHAL's order: the pulse that was prepared before, then the probe, then the next pulse. */
void axis_on_step(void)
{
    PWM_INTR = PWM_SLICE(SLICE_AXIS);
    if (interrupts_to_step == 0u) {
        interrupts_to_step = interrupts_a_step;
        ++axis_pulses;
    }
    if (sr_latch) {
        sr_latch = false;
        stepper_us = TIMER_TIMERAWL;
        stepper_counts = axis_pulses;
        ++stepper_touches;
    }
    --interrupts_to_step;
}

int32_t hal_axis_position_counts(uint8_t axis)
{
    return axis == AXIS ? axis_pulses : 0;
}

/* Interrupt. */
void hal_edge_on_latch(uint8_t channel, uint32_t captured_ticks)
{
    (void)channel; /* this board has one */
    sr_latch = true;
    skip_input_on_edge(&skip, captured_ticks);
}

static void keep_skip_touch(void)
{
    latch_record_t record;
    if (latch_take(&skip.latch, &record)) {
        skip_ticks = record.ticks;
        skip_counts = record.position_counts;
        ++skip_touches;
    }
}

int main(void)
{
    board_start();
    if (skip_input_start(&skip, &SKIP) != HAL_OK) {
        return 1; /* the table above asks for what the board does not have */
    }
    latch_arm(&skip.latch, &LATCH);
    for (;;) {
        uint32_t feed = (uint32_t)uart_take_byte() - '0';
        if (feed < FEEDS) {
            axis_run(FEEDS_MM_PER_MIN[feed]);
        }
        skip_input_poll(&skip, hal_clock_now_ticks());
        keep_skip_touch();
    }
}
