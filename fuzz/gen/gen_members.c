#include "fuzz/gen/gen_members.h"

#include "fuzz/gen/gen.h"
#include "fuzz/gen/gen_sketch.h"

/* One member in that many is one that the products of tests leave out. */
#define OTHER_IN 4u
/* One trial in that many has triangles cut before the build, if its builder takes their parts. */
#define PRESPLIT_IN 8u
/* One trial in that many has steps, if it has no more triangles; up to so many steps. */
#define STEPS_IN        64u
#define STEPS_TRIANGLES 512u
#define STEPS_MOST      4u
#define STEP_SEEDS      1000u

/* A random member of a table that may take part: of the products, or of the others, each as likely.
 * `is_core`: whether member i is of the products; `is_here`: whether it is there on any machine. */
#define CHOOSER(function, type, table, is_core, is_here)                                           \
    const struct type *function(struct rng *rng, bool faithful)                                    \
    {                                                                                              \
        uint32_t allowed[2] = {0, 0};                                                              \
        bool core = rng_below(rng, OTHER_IN) != 0;                                                 \
        for (size_t i = 0; (table)[i]; i++)                                                        \
            allowed[is_core] += (is_here) && (faithful || !(table)[i]->faithful);                  \
        core = core || allowed[0] == 0;                                                            \
        uint32_t skip = rng_below(rng, allowed[core]);                                             \
        for (size_t i = 0;; i++)                                                                   \
            if ((is_here) && (faithful || !(table)[i]->faithful) && (is_core) == core &&           \
                skip-- == 0)                                                                       \
                return (table)[i];                                                                 \
    }

static size_t core_builders(void)
{
    size_t count = 0;
    while (builders[count])
        count++;
    return count;
}

CHOOSER(gen_builder, builder, builders_all, i < core_builders(), !builders_all[i]->compare)
CHOOSER(gen_box_test, box_test, box_tests, true, true)
CHOOSER(gen_tri_test, tri_test, tri_tests, tri_tests[i]->core, true)

uint32_t gen_leaf(struct rng *rng, bool faithful)
{
    static const uint8_t often[] = {4, 4, 4, 4, 4, 1, 1, 2, 2, 3, 5, 6, 7, 8, 8, 8};
    uint32_t beyond = 9 + rng_below(rng, 8);
    uint32_t leaf = often[rng_below(rng, ARRAY_COUNT(often))];
    return rng_below(rng, 32) == 0 && faithful ? beyond : leaf;
}

float gen_eps(struct rng *rng)
{
    uint32_t how = rng_below(rng, 4);
    int exponent = (int)rng_below(rng, 31);
    return how < 2 ? BUILD_EPS_DEFAULT : how == 2 ? 0.0f : power_of_two(-exponent);
}

float gen_move(struct rng *rng)
{
    return power_of_two((int)rng_below(rng, 12) - 10);
}

float gen_presplit(uint64_t seed, uint64_t index, const struct builder *builder)
{
    struct rng of_seed = rng_make(seed, 0x70617274u + GEN_SALT);
    struct rng rng = rng_make(rng_u64(&of_seed), index);
    bool some = rng_below(&rng, PRESPLIT_IN) == 0;
    float share = power_of_two((int)rng_below(&rng, 6) - 4);
    return some && builder_takes(builder, "presplit") ? share : 0;
}

/* Two steps in three are refits; a motion that is still is as rare as any other. */
void gen_steps(uint64_t seed, uint64_t index, bool every, struct fuzz_trial *trial)
{
    struct rng of_seed = rng_make(seed, 0x73746570u + GEN_SALT);
    struct rng rng = rng_make(rng_u64(&of_seed), index);
    const bool some = rng_below(&rng, STEPS_IN) == 0;
    if (!(some || every) || trial->scene.tri_count > STEPS_TRIANGLES)
        return;
    trial->step_count = 1 + rng_below(&rng, STEPS_MOST);
    for (uint32_t i = 0; i < trial->step_count; i++) {
        struct step *step = &trial->step[i];
        step->act = rng_below(&rng, 3) == 0 ? LIFE_REBUILD : LIFE_REFIT;
        step->motion =
            (enum life_motion)rng_below(&rng, trial->world.is ? MOTIONS : MOTIONS_OF_VERTICES);
        step->seed = rng_below(&rng, STEP_SEEDS);
    }
}
