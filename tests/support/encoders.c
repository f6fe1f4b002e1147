#include "encoders.h"

#include <math.h>

#define TWO_PI 6.283185307179586

void encoders_start(encoders_t *e, const encoders_setup_t *setup)
{
    *e = (encoders_t){.setup = setup};
}

static double output_turns(const encoders_setup_t *setup, double line)
{
    return (line + setup->phase) / setup->lines2;
}

double encoders_error_arcsec(const encoders_setup_t *setup, double line)
{
    return setup->error_arcsec * sin(TWO_PI * output_turns(setup, line));
}

/* Where the input is when a shaft stands at its line. */
static double input_turns(const encoders_setup_t *setup, int shaft, double line, bool back)
{
    if (shaft == 0) {
        return line / setup->lines1;
    }
    double behind = encoders_error_arcsec(setup, line) + (back ? setup->backlash_arcsec : 0.0);
    return setup->ratio * (output_turns(setup, line) - behind / ENCODERS_ARCSEC_PER_TURN);
}

static double time_to_s(const encoders_setup_t *setup, double turns)
{
    return (turns + setup->ripple / TWO_PI * sin(TWO_PI * turns)) / setup->input_rev_per_s;
}

static double time_s(const encoders_setup_t *setup, int shaft, double line, bool back)
{
    double to_s = time_to_s(setup, input_turns(setup, shaft, line, back));
    if (!back) {
        return to_s;
    }
    return 2.0 * time_to_s(setup, setup->turning_turns) + setup->standstill_s - to_s;
}

static bool turns_back(const encoders_t *e, int shaft)
{
    const encoders_setup_t *setup = e->setup;
    return !e->back && setup->turning_turns > 0.0 &&
           input_turns(setup, shaft, e->next_line[shaft], false) > setup->turning_turns;
}

static void begin_way_back(encoders_t *e)
{
    e->back = true;
    for (int shaft = 0; shaft < 2; ++shaft) {
        e->next_line[shaft] -= 1.0;
    }
}

bool encoders_next(encoders_t *e, encoders_pulse_t *pulse)
{
    if (turns_back(e, 0) && turns_back(e, 1)) {
        begin_way_back(e);
    }
    double times[2];
    for (int shaft = 0; shaft < 2; ++shaft) {
        times[shaft] =
            turns_back(e, shaft) ? INFINITY : time_s(e->setup, shaft, e->next_line[shaft], e->back);
    }
    int shaft = times[1] < times[0];
    *pulse = (encoders_pulse_t){
        .channel = (uint8_t)(shaft + 1 + (e->back ? 128 : 0)),
        .ticks = (uint32_t)(uint64_t)floor(times[shaft] / e->setup->tick_s) + e->setup->start_ticks,
        .time_s = times[shaft],
        .line = e->next_line[shaft],
    };
    e->next_line[shaft] += e->back ? -1.0 : 1.0;
    return pulse->line >= 0.0;
}
