/* How much wider an uncertainty gets when the scatter was estimated from few residuals. Task. */
#ifndef COMP_KINEMATICS_COVERAGE_H
#define COMP_KINEMATICS_COVERAGE_H

#include <stdint.h>

/* t₉₉.₇₃(freedom)/3, above 1, for `freedom` ≥ 1 (GUM, table G.2). */
double coverage_factor(int32_t freedom);

#endif
