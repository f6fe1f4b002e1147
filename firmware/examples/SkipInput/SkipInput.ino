// Latches the falling edge of a probe on pin 2, in microseconds; A0 stands for the axis.
#include <skiplatch.h>

const uint8_t PROBE_PIN = 2;
skip_input_t  input;
latch_config_t latch_config;

static void on_edge() { skip_input_on_edge(&input, micros()); }
int hal_edge_arm(const hal_edge_config_t *) { attachInterrupt(digitalPinToInterrupt(PROBE_PIN), on_edge, FALLING); return HAL_OK; }
void hal_edge_disarm(uint8_t) { detachInterrupt(digitalPinToInterrupt(PROBE_PIN)); }
bool hal_edge_level(uint8_t) { return digitalRead(PROBE_PIN) == LOW; }
int32_t hal_axis_position_counts(uint8_t) { return 0; } // your step counter
hal_critical_state_t hal_critical_enter(void) { noInterrupts(); return 0; }
void hal_critical_exit(hal_critical_state_t) { interrupts(); } // the core masks in loop() only

void setup()
{
    Serial.begin(115200);
    pinMode(PROBE_PIN, INPUT_PULLUP);
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
