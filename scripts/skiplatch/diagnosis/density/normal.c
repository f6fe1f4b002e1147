#include "diagnosis/density/normal.h"

#include <math.h>

#define SQRT_2    1.4142135623730951
#define SQRT_2_PI 2.5066282746310002
#define PER_UNIT  64  /* nodes of the table */
#define NODES     577 /* up to NORMAL_END */

/* What the law has at a node, z ≥ 0. */
typedef struct {
    double density;
    double above;
    double rounding;
} node_t;

/* A node, and how far beyond it a value is. */
typedef struct {
    const node_t *node;
    double        z;
    double        beyond;
} place_t;

static node_t nodes[NODES];

double normal_density(double z)
{
    return exp(-0.5 * z * z) / SQRT_2_PI;
}

/* Filled as the library is loaded, before any thread can ask for it. */
__attribute__((constructor)) static void fill(void)
{
    for (int i = 0; i < NODES; ++i) {
        double z = (double)i / PER_UNIT;
        double density = normal_density(z);
        double above = 0.5 * erfc(z / SQRT_2);
        nodes[i] = (node_t){.density = density, .above = above, .rounding = density - z * above};
    }
}

static place_t place_of(double z)
{
    int i = (int)(z * PER_UNIT + 0.5);
    return (place_t){
        .node = &nodes[i], .z = (double)i / PER_UNIT, .beyond = z - (double)i / PER_UNIT};
}

/* Hermite's polynomials at a node: the coefficients of Taylor's series of the density. */
typedef struct {
    double second;
    double third;
    double fourth;
} hermite_t;

static hermite_t hermite(double z)
{
    return (hermite_t){
        .second = z * z - 1.0, .third = z * (z * z - 3.0), .fourth = z * z * (z * z - 6.0) + 3.0};
}

/* The density integrated from a node on, over that at the node. */
static double grown(place_t at)
{
    double    h = at.beyond;
    hermite_t of = hermite(at.z);
    double    rest = of.second - h / 4.0 * (of.third - h / 5.0 * of.fourth);
    return h * (1.0 - h / 2.0 * (at.z - h / 3.0 * rest));
}

/* That integrated once more. */
static double grown_twice(place_t at)
{
    double    h = at.beyond;
    hermite_t of = hermite(at.z);
    double    rest = of.second - h / 5.0 * (of.third - h / 6.0 * of.fourth);
    return h * h / 2.0 * (1.0 - h / 3.0 * (at.z - h / 4.0 * rest));
}

double normal_below(double z)
{
    place_t at = place_of(fabs(z));
    double  above = at.node->above - at.node->density * grown(at);
    return z < 0.0 ? above : 1.0 - above;
}

double normal_rounding(double z)
{
    place_t at = place_of(z);
    return at.node->rounding - at.node->above * at.beyond + at.node->density * grown_twice(at);
}
