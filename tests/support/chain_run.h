/* Plays a train of pulses through the firmware and keeps how far its points are from the truth. */
#ifndef CHAIN_RUN_H
#define CHAIN_RUN_H

#include "comp/transmission.h"
#include "encoders.h"

#define ARCSEC_PER_NAS 1.0e-9

typedef struct {
    transmission_t       core;
    encoders_setup_t     setup;
    transmission_point_t last;
    double               points;
    double               lowest; /* of what was measured, arcseconds */
    double               highest;
    double               sum_off; /* measured minus planted */
    double               lowest_off;
    double               highest_off;
} chain_run_t;

void chain_run_start(chain_run_t *run, const encoders_setup_t *setup,
                     const transmission_config_t *config);

/* Hand a pulse to the firmware and look at the points that it brings. */
void chain_run_pulse(chain_run_t *run, uint8_t channel, uint32_t ticks);

/* Forget what was seen of the points until now. */
void chain_run_look_again(chain_run_t *run);

/* All pulses of an undisturbed chain until the output has passed `lines` lines. */
void chain_run_lines(chain_run_t *run, encoders_t *encoders, double lines);

double chain_run_mean_off(const chain_run_t *run);

/* Half the width of the band in which measured minus planted lies. */
double chain_run_off(const chain_run_t *run);

#endif
