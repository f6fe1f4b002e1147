/* Numbers of single touches. Behind physics.h; nobody else uses it. */
#ifndef DIAGNOSIS_NUMBERS_H
#define DIAGNOSIS_NUMBERS_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "diagnosis/likelihood/physics.h"

#define CALM 3.0 /* standard deviations beyond which a touch tells no more of what others have */

static inline double number_at(sim_number_t number, uint64_t i)
{
    return number.each != NULL ? number.each[i] : number.all;
}

static inline double limited(double value, double most)
{
    return fmin(fmax(value, -most), most);
}

/* Bring a value to within half a period of 0 by whole periods. */
static inline double folded(double value, double period)
{
    double turned = value + period / 2.0;
    return turned - period * floor(turned / period) - period / 2.0;
}

static inline bool is_polled(uint32_t stream)
{
    return stream == SIM_LATCH_PLC || stream == SIM_DEVIATION_PLC;
}

static inline bool is_deviation(uint32_t stream)
{
    return stream == SIM_DEVIATION_SKIP || stream == SIM_DEVIATION_PLC;
}

static inline bool is_beyond_stamp(uint32_t stream)
{
    return stream == SIM_POSITION || stream == SIM_ARRIVAL;
}

static inline bool is_length(uint32_t stream)
{
    return stream == SIM_POSITION || is_deviation(stream);
}

static inline bool is_after_latch(uint32_t stream)
{
    return stream == SIM_POSITION || stream == SIM_REPORT;
}

#endif
