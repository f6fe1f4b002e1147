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

static void probe_on_old_edge() {}

// The probe is channel 0, low while it is deflected whatever the polarity asked for; there is no filter.
int hal_edge_arm(const hal_edge_config_t *config)
{
    if (config->channel != 0) {
        return HAL_ERR_CHANNEL;
    }
    if (config->glitch_filter_us != 0 || probe_on_edge == nullptr) {
        return HAL_ERR_CONFIG;
    }
    // The chip may remember an edge from before, or take the choice of the edge for one: those come
    // now, and go nowhere. Interrupts have to be on, as they are in setup() and loop().
    attachInterrupt(digitalPinToInterrupt(probe_pin), probe_on_old_edge, FALLING);
    attachInterrupt(digitalPinToInterrupt(probe_pin), probe_on_edge, FALLING);
    return HAL_OK;
}

void hal_edge_disarm(uint8_t channel)
{
    if (channel == 0) {
        detachInterrupt(digitalPinToInterrupt(probe_pin));
    }
}

bool hal_edge_level(uint8_t channel) { return channel == 0 && digitalRead(probe_pin) == LOW; }

// Sections nest, in interrupts too: the mask is put back as it was, so it has to be read first.
#if defined(SREG)
hal_critical_state_t hal_critical_enter(void)
{
    hal_critical_state_t saved = SREG;
    noInterrupts();
    return saved;
}

void hal_critical_exit(hal_critical_state_t saved)
{
    asm volatile("" ::: "memory");
    SREG = static_cast<uint8_t>(saved);
}
#elif defined(__arm__)
hal_critical_state_t hal_critical_enter(void)
{
    hal_critical_state_t saved;
    asm volatile("mrs %0, primask\n cpsid i" : "=r"(saved)::"memory");
    return saved;
}

void hal_critical_exit(hal_critical_state_t saved) { asm volatile("msr primask, %0" ::"r"(saved) : "memory"); }
#else
#error "skiplatch_arduino.hpp: AVR and Cortex-M only; elsewhere write hal_critical_enter() and _exit() here"
#endif
