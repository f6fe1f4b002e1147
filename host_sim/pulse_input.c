#include "pulse_input.h"

/* Where there was no room, all are dropped until the task has caught up, as on a board. */
static void note(sim_pulse_input_t *input, uint8_t channel, uint32_t ticks)
{
    uint32_t kept = input->noted - input->taken;
    if (kept == SIM_PULSES_HELD || (input->lost != 0u && kept != 0u)) {
        input->lost = (uint8_t)(input->lost + (input->lost < UINT8_MAX));
        return;
    }
    input->held[input->noted % SIM_PULSES_HELD] =
        (hal_pulse_t){.captured_ticks = ticks, .channel = channel, .lost = input->lost};
    input->lost = 0u;
    ++input->noted;
}

void sim_pulse_input_set(sim_pulse_input_t *input, uint8_t channel, bool high, uint32_t ticks)
{
    if (channel >= HAL_PULSE_CHANNELS) {
        return;
    }
    if (input->is_started && high != input->levels[channel] && high == input->notes_high) {
        note(input, channel, ticks);
    }
    input->levels[channel] = high;
}

void sim_pulse_input_start(sim_pulse_input_t *input, hal_pulse_edge_t edge)
{
    sim_pulse_input_stop(input);
    input->notes_high = edge == HAL_PULSE_RISING;
    input->is_started = true;
}

void sim_pulse_input_stop(sim_pulse_input_t *input)
{
    input->is_started = false;
    input->taken = input->noted;
    input->lost = 0u;
}

bool sim_pulse_input_take(sim_pulse_input_t *input, hal_pulse_t *pulse)
{
    if (input->taken == input->noted) {
        return false;
    }
    *pulse = input->held[input->taken % SIM_PULSES_HELD];
    ++input->taken;
    return true;
}
