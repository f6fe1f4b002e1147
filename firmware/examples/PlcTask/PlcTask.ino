// What a polled input makes of the same probe: a scan every millisecond, up to that much too late.
#include <skiplatch.h>

const uint8_t PROBE_PIN = 2;
plc_task_t    task;
latch_config_t latch_config;
uint32_t      next_us;

uint32_t hal_clock_now_ticks(void) { return micros(); }
uint32_t hal_clock_tick_ps(void) { return 1000000; }
bool hal_edge_level(uint8_t) { return digitalRead(PROBE_PIN) == LOW; }
int32_t hal_axis_position_counts(uint8_t) { return 0; } // your step counter
hal_critical_state_t hal_critical_enter(void) { noInterrupts(); return 0; }
void hal_critical_exit(hal_critical_state_t) { interrupts(); } // the core masks in loop() only

void setup()
{
    Serial.begin(115200);
    pinMode(PROBE_PIN, INPUT_PULLUP);
    latch_config.repeated = true;
    latch_config.confirm_ticks = 2000;
    latch_config.holdoff_ticks = 10000;
    plc_task_config_t config = {};
    config.period_us = 1000;
    plc_task_start(&task, &config);
    latch_arm(&task.latch, &latch_config);
    next_us = micros();
}

void loop()
{
    latch_record_t record;
    if (static_cast<int32_t>(micros() - next_us) >= 0) {
        next_us += 1000;
        plc_task_scan(&task);
    }
    if (latch_take(&task.latch, &record)) {
        Serial.println(record.ticks);
    }
}
