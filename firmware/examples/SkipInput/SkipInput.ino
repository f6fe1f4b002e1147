// Latches the falling edge of a probe on pin 2, in microseconds.
#include <skiplatch_arduino.hpp>

skip_input_t   input;
latch_config_t latch_config;

static void on_edge() { skip_input_on_edge(&input, micros()); }
int32_t hal_axis_position_counts(uint8_t) { return 0; } // your step counter

void setup()
{
    Serial.begin(115200);
    probe_start(2, on_edge);
    latch_config.repeated = true;
    latch_config.confirm_ticks = 500;
    latch_config.holdoff_ticks = 10000;
    skip_input_config_t config = {};
    skip_input_start(&input, &config);
    latch_arm(&input.latch, &latch_config);
}

void loop()
{
    latch_record_t record;
    skip_input_poll(&input, micros());
    if (latch_take(&input.latch, &record)) {
        Serial.println(record.ticks);
    }
}
