// What a polled input makes of the same probe: a scan every millisecond, up to that much too late.
#include <skiplatch_arduino.hpp>

plc_task_t     task;
latch_config_t latch_config;
uint32_t       next_us;

int32_t hal_axis_position_counts(uint8_t) { return 0; } // your step counter

void setup()
{
    Serial.begin(115200);
    probe_start(2);
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
