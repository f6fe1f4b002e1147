/*
 * Random numbers that depend only on (seed, replicate, touch): the same on any number of threads
 * and in any order of touches. Philox 4x32-10 of Random123, a counter-based generator.
 */
#ifndef SIM_RANDOM_H
#define SIM_RANDOM_H

#include <stdint.h>

typedef struct {
    uint32_t key[2];
    uint32_t counter[4];
    uint32_t words[4]; /* the block drawn last */
    uint32_t used;     /* of those words */
} sim_random_t;

/*
 * Begin the stream of one touch; UINT64_MAX as `touch` is the stream of the whole campaign. Lanes,
 * 0 to 255, are independent of one another: the nominal chain has lane 0.
 */
void sim_random_begin(sim_random_t *random, uint64_t seed, uint64_t replicate, uint64_t touch,
                      uint32_t lane);

/* Uniform in [0, width). */
double sim_random_uniform(sim_random_t *random, double width);

/* How many means the farthest draw from an exponential law is: log(2^32). */
#define SIM_RANDOM_FARTHEST 22.2

/* Exponential, from 0 on. */
double sim_random_exponential(sim_random_t *random, double mean);

/* Normal with mean 0. */
double sim_random_normal(sim_random_t *random, double sigma);

#endif
