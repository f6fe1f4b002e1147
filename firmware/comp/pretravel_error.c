#include "comp/pretravel.h"

/* Apart from the mathematics, so that a controller that tells no sentences stores none. */
static const char *const SENTENCES[] = {
    [-PRETRAVEL_OK] = "all is well",
    [-PRETRAVEL_ERR_NOT_FINITE] = "a value is not a finite number",
    [-PRETRAVEL_ERR_DIRECTION] =
        "an angle is out of range: alpha -360 to 360, beta 0 to 90 degrees",
    [-PRETRAVEL_ERR_FEW_DIRECTIONS] =
        "too few directions: a map wants at least 6, and 3 azimuths on each parallel",
    [-PRETRAVEL_ERR_GAP] = "the map has a gap: directions are missing",
    [-PRETRAVEL_ERR_CAPACITY] = "more directions than there is room for",
    [-PRETRAVEL_ERR_FEW_RUNS] = "too few runs: tau and its uncertainty want at least 3",
    [-PRETRAVEL_ERR_ONE_SPEED] = "all runs have one speed: tau wants at least 2",
    [-PRETRAVEL_ERR_TAU] = "tau has to be above 0",
    [-PRETRAVEL_ERR_SPEED] = "a speed has to be above 0",
    [-PRETRAVEL_ERR_TOO_SLOW] = "the compensated speed would have to be 0 or less",
    [-PRETRAVEL_ERR_TOO_FAST] = "the compensated speed is above the maximum",
    [-PRETRAVEL_ERR_OVERTRAVEL] = "the compensated speed has more overtravel than is allowed",
    [-PRETRAVEL_ERR_RAMP] = "the compensated speed is not reached within the approach",
    [-PRETRAVEL_ERR_LIMIT] = "a limit has to be above 0",
    [-PRETRAVEL_ERR_FEW_POINTS] = "too few points: a circle wants 3, a sphere 4",
    [-PRETRAVEL_ERR_CENTRE] = "the points do not tell where the centre is",
    [-PRETRAVEL_ERR_SCALE] = "a speed does not fit into the units of the table",
    [-PRETRAVEL_ERR_DIVISIONS] = "the table can be divided by 2, 4, 8, 16 or 32 only",
};

const char *pretravel_error(int code)
{
    const int count = (int)(sizeof SENTENCES / sizeof SENTENCES[0]);
    return code <= 0 && code > -count ? SENTENCES[-code] : "no such code";
}
