/* Scenes and rays made of one kind of tests/exact/oracle_cases.c. */
#ifndef TESTS_ORACLE_BATCH_H
#define TESTS_ORACLE_BATCH_H

#include "ref/oracle/oracle.h"
#include "tests/exact/oracle_cases.h"

#include <stdlib.h>

#define BATCH 16 /* triangles of a scene, and rays aimed at them */

struct oracle_batch {
    struct scene scene;
    struct oracle *oracle;
    struct ray ray[BATCH];
};

/* Sequences of neighbouring seeds are one sequence, shifted by a number (ref/base/rng.h): start
 * anywhere instead, or batches would repeat each other's triangles. */
static inline struct rng far_rng(uint64_t seed)
{
    struct rng start = rng_make(seed, 1);
    return (struct rng){rng_u64(&start)};
}

static inline void batch_make(const struct oracle_case *kind, uint64_t seed,
                              struct oracle_batch *out)
{
    struct rng rng = far_rng(seed);
    struct reason reason = {""};
    if (scene_make(3 * BATCH, BATCH, &out->scene))
        abort();
    for (uint32_t i = 0; i < BATCH; i++) {
        float v[3][3];
        kind->make(&rng, seed, &out->ray[i], v);
        for (uint32_t c = 0; c < 3; c++) {
            out->scene.index[3 * i + c] = 3 * i + c;
            for (uint32_t k = 0; k < 3; k++)
                out->scene.vertex[9 * i + 3 * c + k] = v[c][k];
        }
    }
    if (oracle_make(&out->scene, &out->oracle, &reason))
        abort();
}

static inline void batch_free(struct oracle_batch *batch)
{
    oracle_free(batch->oracle);
    scene_free(&batch->scene);
}

/* `usual` pairs or rays per kind, 10^6 with RAYDIFF_SLOW=1. */
static inline size_t count_per_kind(size_t usual)
{
    const char *slow = getenv("RAYDIFF_SLOW");
    return slow && slow[0] == '1' ? 1000000 : usual;
}

#endif
