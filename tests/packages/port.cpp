// A port in C++: every function of the HAL, and a touch through the core written in C.
#include <cstdio>

#include "hal_pulse.h"
#include "skiplatch.h"

namespace {
bool         deflected;
skip_input_t input;
unsigned     frames_sent;
} // namespace

uint32_t hal_clock_now_ticks(void) { return 1100U; }
uint32_t hal_clock_tick_ps(void) { return 1000000U; }
int32_t  hal_axis_position_counts(uint8_t) { return -4711; }
int      hal_edge_arm(const hal_edge_config_t *) { return HAL_OK; }
void     hal_edge_disarm(uint8_t) {}
bool     hal_edge_level(uint8_t) { return deflected; }
int      hal_pulse_start(hal_pulse_edge_t) { return HAL_ERR_CONFIG; }
void     hal_pulse_stop(void) {}
bool     hal_pulse_take(hal_pulse_t *) { return false; }

hal_critical_state_t hal_critical_enter(void) { return 0U; }
void                 hal_critical_exit(hal_critical_state_t) {}

int hal_bus_send(const uint8_t[HAL_BUS_FRAME_BYTES])
{
    ++frames_sent;
    return HAL_OK;
}

void hal_edge_on_latch(uint8_t, uint32_t captured_ticks)
{
    skip_input_on_edge(&input, captured_ticks);
}

extern void *const exported[]; // every function of the firmware, by a file the test writes
extern const unsigned exported_count;

int main()
{
    skip_input_config_t config{};
    latch_config_t      confirm{};
    latch_record_t      record{};
    latch_report_t      report{};
    confirm.confirm_ticks = 50U;
    skip_input_start(&input, &config);
    latch_arm(&input.latch, &confirm);
    deflected = true;
    hal_edge_on_latch(0U, 1000U);
    skip_input_poll(&input, hal_clock_now_ticks());

    bool taken = latch_take(&input.latch, &record) && latch_report_begin(&report, &record) &&
                 latch_report_poll(&report);
    for (unsigned i = 0U; i < exported_count; ++i) {
        taken = taken && exported[i] != nullptr;
    }
    std::printf("%d %lu %ld %u\n", taken ? 1 : 0, static_cast<unsigned long>(record.ticks),
                static_cast<long>(record.position_counts), frames_sent);
    return 0;
}
