/* How likely one residual is under its law and its extras. Only law.c uses it. */
#ifndef DIAGNOSIS_RESIDUAL_H
#define DIAGNOSIS_RESIDUAL_H

#include <stdint.h>

#include "diagnosis/density/law.h"

/* Logarithm of the density of residual i, moved by -moved, in its unit. */
double residual_log_density(const sim_residuals_t *of, uint64_t i, double moved);

#endif
