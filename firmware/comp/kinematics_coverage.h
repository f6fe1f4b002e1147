/* How much wider an uncertainty gets when the scatter was estimated from few residuals. Task. */
#ifndef COMP_KINEMATICS_COVERAGE_H
#define COMP_KINEMATICS_COVERAGE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* t₉₉.₇₃(freedom)/3, above 1, for `freedom` ≥ 1 (GUM, table G.2). */
double kinematics_coverage_factor(int32_t freedom);

#ifdef __cplusplus
}
#endif

#endif
