/* Virtual time: integer nanoseconds on the master clock, 0 at the start of the campaign. */
#ifndef SIM_TIME_H
#define SIM_TIME_H

#include <math.h>
#include <stdint.h>

typedef int64_t sim_ns_t;

#define SIM_NEVER     INT64_MAX
#define SIM_NS_PER_US 1000.0
#define SIM_NS_PER_S  1.0e9
#define SIM_PS_PER_NS 1000

/* The longest campaign, 100 days: leaves room for picoseconds in 64 bits. */
#define SIM_NS_MAX ((sim_ns_t)8640000 * 1000000000)

static inline sim_ns_t sim_ns_from_us(double us)
{
    return (sim_ns_t)llrint(us * SIM_NS_PER_US);
}

static inline sim_ns_t sim_ns_from_s(double s)
{
    return (sim_ns_t)llrint(s * SIM_NS_PER_S);
}

static inline double sim_us_from_ns(sim_ns_t ns)
{
    return (double)ns / SIM_NS_PER_US;
}

#endif
