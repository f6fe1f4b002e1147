// The HAL on a board that runs Arduino, for one probe that pulls its pin low; a tick is 1 µs. Include
// it once, in the sketch, which brings hal_axis_position_counts().
#pragma once

#include <Arduino.h>
#include <skiplatch.h>

static uint8_t probe_pin;
static void (*probe_on_edge)();

// Before anything else. on_edge is called by the interrupt of the pin; without one the pin is polled.
static void probe_start(uint8_t pin, void (*on_edge)() = nullptr)
{
    probe_pin = pin;
    probe_on_edge = on_edge;
    pinMode(pin, INPUT_PULLUP);
}

uint32_t hal_clock_now_ticks(void) { return micros(); }
uint32_t hal_clock_tick_ps(void) { return 1000000; }

int hal_edge_arm(const hal_edge_config_t *)
{
    attachInterrupt(digitalPinToInterrupt(probe_pin), probe_on_edge, FALLING);
    return HAL_OK;
}

void hal_edge_disarm(uint8_t) { detachInterrupt(digitalPinToInterrupt(probe_pin)); }
bool hal_edge_level(uint8_t) { return digitalRead(probe_pin) == LOW; }

// The core masks in loop() only, where interrupts are on.
hal_critical_state_t hal_critical_enter(void) { noInterrupts(); return 0; }
void hal_critical_exit(hal_critical_state_t) { interrupts(); }
