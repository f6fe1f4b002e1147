/* Which gear trains can be simulated. sim_gear_error() is here. Only gear_train.c uses it. */
#ifndef SIM_GEAR_CHECK_H
#define SIM_GEAR_CHECK_H

#include "gear_train.h"

/* SIM_GEAR_OK, or what is wrong first. */
int sim_gear_check(const sim_gear_train_t *train);

#endif
