// The HAL for Arduino held against its contract, on a stand-in of the AVR's core.
#include <cstdint>
#include <cstdio>

static uint8_t status_register = 0x80U; // interrupts are on
#define SREG status_register
#include <skiplatch_arduino.hpp>

namespace {
int   level = 1;
bool  pending; // an edge from before is remembered by the chip, and comes once somebody listens
void (*attached)();
int   detached;
int   edges;

void on_edge() { ++edges; }

int failures;

void check(bool holds, const char *what)
{
    if (!holds) {
        std::printf("%s\n", what);
        ++failures;
    }
}

hal_edge_config_t config_of(uint8_t channel, uint16_t glitch_filter_us)
{
    hal_edge_config_t config{};
    config.channel = channel;
    config.glitch_filter_us = glitch_filter_us;
    return config;
}

int arm(uint8_t channel, uint16_t glitch_filter_us)
{
    const hal_edge_config_t config = config_of(channel, glitch_filter_us);
    return hal_edge_arm(&config);
}

void check_edges()
{
    probe_start(2);
    check(arm(0, 0) == HAL_ERR_CONFIG, "an edge that nobody takes is refused");
    probe_start(2, on_edge);
    check(arm(1, 0) == HAL_ERR_CHANNEL, "an unknown channel is refused");
    check(arm(0, 1) == HAL_ERR_CONFIG, "a filter is refused");
    check(attached == nullptr, "what is refused is not watched");
    pending = true;
    check(arm(0, 0) == HAL_OK && attached == on_edge, "the probe is watched");
    check(edges == 0 && !pending, "an edge from before arming is not delivered");
    hal_edge_disarm(1);
    check(detached == 0, "an unknown channel is not disarmed");
    hal_edge_disarm(0);
    check(detached == 1, "the probe is disarmed");
    level = LOW;
    check(hal_edge_level(0), "a low pin is deflected");
    check(!hal_edge_level(1), "an unknown channel is free");
}

bool is_masked() { return (status_register & 0x80U) == 0U; }

void check_sections()
{
    hal_critical_state_t outer = hal_critical_enter();
    hal_critical_state_t inner = hal_critical_enter();
    hal_critical_exit(inner);
    check(is_masked(), "an inner section does not end the outer one");
    hal_critical_exit(outer);
    check(!is_masked(), "the outer one ends");
    noInterrupts(); // as in an interrupt
    hal_critical_exit(hal_critical_enter());
    check(is_masked(), "a section in an interrupt leaves it masked");
}
} // namespace

int      digitalPinToInterrupt(uint8_t pin) { return pin; }
void     attachInterrupt(int, void (*handler)(), int)
{
    attached = handler;
    if (pending) {
        pending = false;
        handler();
    }
}
void     detachInterrupt(int) { ++detached; }
int      digitalRead(uint8_t) { return level; }
void     pinMode(uint8_t, uint8_t) {}
void     noInterrupts() { status_register = 0U; }
uint32_t micros() { return 0U; }

int main()
{
    check_edges();
    check_sections();
    return failures;
}
