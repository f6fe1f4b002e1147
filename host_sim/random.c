#include "random.h"

#include <math.h>

#include <Random123/philox.h>

#include "angle.h"

#define TWO_POW_32 4294967296.0
#define BLOCK      4u
#define LANE_SHIFT 24u /* so many blocks a lane, to the power of two */

void sim_random_begin(sim_random_t *random, uint64_t seed, uint64_t replicate, uint64_t touch,
                      uint32_t lane)
{
    /* The seed fills the key; replicate and touch pick a counter of their own. */
    random->key[0] = (uint32_t)seed;
    random->key[1] = (uint32_t)(seed >> 32);
    random->counter[0] = lane << LANE_SHIFT;
    random->counter[1] = (uint32_t)replicate;
    random->counter[2] = (uint32_t)touch;
    random->counter[3] = (uint32_t)(touch >> 32);
    random->used = BLOCK;
}

static void draw_block(sim_random_t *random)
{
    philox4x32_key_t key = {{random->key[0], random->key[1]}};
    philox4x32_ctr_t counter = {
        {random->counter[0], random->counter[1], random->counter[2], random->counter[3]}};
    philox4x32_ctr_t words = philox4x32(counter, key);

    for (uint32_t i = 0; i < BLOCK; ++i) {
        random->words[i] = words.v[i];
    }
    ++random->counter[0];
    random->used = 0u;
}

static uint32_t next_word(sim_random_t *random)
{
    if (random->used == BLOCK) {
        draw_block(random);
    }
    return random->words[random->used++];
}

double sim_random_uniform(sim_random_t *random, double width)
{
    return width * ((double)next_word(random) / TWO_POW_32);
}

double sim_random_exponential(sim_random_t *random, double mean)
{
    return -mean * log1p(-sim_random_uniform(random, 1.0));
}

/* Box-Muller; the half keeps the logarithm finite. */
double sim_random_normal(sim_random_t *random, double sigma)
{
    double radius = sqrt(-2.0 * log(((double)next_word(random) + 0.5) / TWO_POW_32));
    double angle = 2.0 * PI * ((double)next_word(random) / TWO_POW_32);
    return sigma * radius * cos(angle);
}
