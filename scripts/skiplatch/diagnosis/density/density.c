#include "diagnosis/density/law.h"

#include <math.h>

#include "diagnosis/density/residual.h"

void sim_law_log_density(const sim_residuals_t *of, double *log_densities)
{
    for (uint64_t i = 0; i < of->n; ++i) {
        double density = 0.0;
        for (uint32_t k = 0; k <= of->extra_count; ++k) {
            residual_part_t part = residual_part(of, i, k);
            density += residual_part_density(&part, of->residuals[i]);
        }
        log_densities[i] = log(residual_density(density, of->residuals[i], of->reach[i]));
    }
}
