#include "scan.h"

#include <avr/interrupt.h>
#include <stddef.h>

#include "board.h"
#include "hal_error.h"

#define PERIOD_MIN_US 100u
#define TIMER_TICKS   256u

typedef struct {
    uint8_t tick_us;
    uint8_t bits;
} prescaler_t;

static const prescaler_t PRESCALERS[] = {
    {4u, _BV(CS22)},                          /* 64 */
    {8u, _BV(CS22) | _BV(CS20)},              /* 128 */
    {16u, _BV(CS22) | _BV(CS21)},             /* 256 */
    {64u, _BV(CS22) | _BV(CS21) | _BV(CS20)}, /* 1024 */
};
#define PRESCALER_COUNT (sizeof PRESCALERS / sizeof *PRESCALERS)

static volatile bool is_due;

ISR(TIMER2_COMPA_vect)
{
    is_due = true;
    scan_on_due();
}

bool scan_is_due(void)
{
    return is_due;
}

void scan_run(void)
{
    if (is_due) {
        is_due = false;
        scan_on_time();
    }
}

static const prescaler_t *prescaler_for(uint16_t period_us)
{
    for (size_t i = 0u; i < PRESCALER_COUNT; ++i) {
        uint16_t tick_us = PRESCALERS[i].tick_us;
        if (period_us <= (uint32_t)tick_us * TIMER_TICKS) {
            return period_us % tick_us == 0u ? &PRESCALERS[i] : NULL;
        }
    }
    return NULL;
}

int scan_start(uint16_t period_us)
{
    const prescaler_t *prescaler = prescaler_for(period_us);
    if (prescaler == NULL || period_us < PERIOD_MIN_US) {
        return HAL_ERR_CONFIG;
    }
    TCCR2A = _BV(WGM21);
    OCR2A = (uint8_t)(period_us / prescaler->tick_us - 1u); /* before the clock: see axis.c */
    TIFR2 = _BV(OCF2A);
    TIMSK2 = _BV(OCIE2A);
    TCCR2B = prescaler->bits;
    return HAL_OK;
}
