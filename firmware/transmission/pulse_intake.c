#include "transmission/pulse_intake.h"

#include "hal_clock.h"
#include "hal_error.h"
#include "hal_pulse.h"

#define REST_TICKS (INT32_C(1) << 30) /* half of what comp/transmission can compare */

int pulse_intake_init(pulse_intake_t *intake, const transmission_config_t *config)
{
    intake->dense_ticks = hal_clock_now_ticks();
    intake->lost = 0u;
    intake->parts = 0u;
    intake->is_backward = false;
    intake->is_unsure = false;
    return transmission_init(&intake->core, config);
}

int pulse_intake_turn(pulse_intake_t *intake, bool is_backward)
{
    if (is_backward == intake->is_backward && !intake->is_unsure) {
        return HAL_OK;
    }
    int error = hal_pulse_start(is_backward ? HAL_PULSE_FALLING : HAL_PULSE_RISING);
    intake->is_unsure = error != HAL_OK;
    if (error == HAL_OK) {
        intake->is_backward = is_backward;
    }
    return error;
}

/* The clock will soon have gone so far that before and after are alike. */
static void notice_rest(pulse_intake_t *intake, uint32_t ticks)
{
    if ((int32_t)(ticks - intake->dense_ticks) >= REST_TICKS) {
        transmission_pause(&intake->core);
        intake->dense_ticks = ticks;
    }
}

static void begin_part(pulse_intake_t *intake, uint8_t lost)
{
    intake->lost += lost;
    ++intake->parts;
    transmission_restart(&intake->core);
}

uint8_t pulse_intake_poll(pulse_intake_t *intake)
{
    hal_pulse_t pulse;
    if (!hal_pulse_take(&pulse)) {
        notice_rest(intake, hal_clock_now_ticks());
        return 0u;
    }
    if (pulse.lost != 0u) {
        begin_part(intake, pulse.lost);
    }
    notice_rest(intake, pulse.captured_ticks);
    uint8_t channel = pulse.channel == 0u ? TRANSMISSION_INPUT : TRANSMISSION_OUTPUT;
    if (channel == transmission_dense_channel(&intake->core)) {
        intake->dense_ticks = pulse.captured_ticks;
    }
    if (intake->is_backward) {
        channel = (uint8_t)(channel | TRANSMISSION_BACKWARD);
    }
    return transmission_on_pulse(&intake->core, channel, pulse.captured_ticks);
}
