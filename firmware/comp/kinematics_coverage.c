#include "comp/kinematics_coverage.h"

/* Student's t for 99.73 %; above the table the expansion of Cornish and Fisher at z = 3. */
static const double T_9973[] = {235.784, 19.206, 9.219, 6.620, 5.507, 4.904,
                                4.530,   4.277,  4.094, 3.957, 3.850, 3.764};

#define LISTED ((int32_t)(sizeof T_9973 / sizeof T_9973[0]))

double kinematics_coverage_factor(int32_t freedom)
{
    if (freedom <= LISTED) {
        return T_9973[freedom - 1] / 3.0;
    }
    double per = 1.0 / (double)freedom;
    return 1.0 + per * (2.5 + per * (5.75 + per * 10.07));
}
