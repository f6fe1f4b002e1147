// Stand-in for the Arduino core of a board whose own is not to be had here: what the sketches use.
#pragma once
#include <stdint.h>

enum { LOW = 0, INPUT_PULLUP = 2, FALLING = 3 };
int      digitalPinToInterrupt(uint8_t pin);
void     attachInterrupt(int number, void (*handler)(), int mode);
void     detachInterrupt(int number);
int      digitalRead(uint8_t pin);
void     pinMode(uint8_t pin, uint8_t mode);
void     noInterrupts();
void     interrupts();
uint32_t micros();

struct SerialStandIn {
    void begin(unsigned long baud);
    void println(unsigned long value);
};
extern SerialStandIn Serial;
