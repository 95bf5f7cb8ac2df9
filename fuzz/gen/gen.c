#include "fuzz/gen/gen.h"

#include "fuzz/gen/aim.h"
#include "fuzz/gen/gen_members.h"
#include "fuzz/gen/gen_sketch.h"
#include "fuzz/gen/gen_world.h"
#include "fuzz/gen/mutate.h"
#include "ref/oracle/environment.h"

#include <float.h>
#include <stdio.h>

/* Wider intermediate results would make other bytes. */
_Static_assert(FLT_EVAL_METHOD == 0, "float expressions must be evaluated in float");

/* Neighbouring seeds share nothing, nor do neighbouring indices, nor scenes and worlds. */
static struct rng rng_of_trial(uint64_t seed, uint64_t index, bool world)
{
    struct rng of_seed = rng_make(seed, (world ? 0x776F726Cu : 0x67656E00u) + GEN_SALT);
    return rng_make(rng_u64(&of_seed), index);
}

const struct recipe *gen_recipe(struct rng *rng)
{
    uint32_t at = rng_below(rng, RECIPE_WEIGHTS), i = 0;
    while (at >= recipes[i].weight)
        at -= recipes[i++].weight;
    return &recipes[i];
}

/* Small loose triangles in the middle half of what is there. */
static void fill(struct sketch *sketch)
{
    struct box box = {{-1, -1, -1}, {1, 1, 1}};
    if (sketch->vertex_count > 0) {
        box = box_empty();
        for (uint32_t i = 0; i < sketch->vertex_count; i++)
            box_add_point(&box, sketch->vertex + 3 * (size_t)i);
    }
    while (sketch_room(sketch) > 0) {
        float v[3][3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                float at = 0.25f + 0.5f * rng_float(sketch->rng);
                v[c][k] = box.lo[k] * (1.0f - at) + box.hi[k] * at;
            }
        sketch_loose(sketch, v);
    }
}

void gen_draw(const struct recipe *recipe, struct sketch *sketch)
{
    if (sketch->goal > 0)
        recipe->draw(sketch);
    fill(sketch);
}

static void draw(const struct recipe *recipe, struct rng *rng, uint32_t goal,
                 struct fuzz_trial *trial, struct sketch *sketch)
{
    *sketch = (struct sketch){
        .rng = rng, .vertex = trial->scene.vertex, .index = trial->scene.index, .goal = goal};
    gen_draw(recipe, sketch);
    trial->scene.vertex_count = sketch->vertex_count;
    trial->scene.tri_count = sketch->tri_count;
}

void gen_choose_tests(struct rng *rng, const struct gen_options *options, uint32_t leaf,
                      struct fuzz_trial *trial)
{
    uint32_t any_leaf = gen_leaf(rng, options->faithful);
    trial->build.leaf = leaf ? leaf : any_leaf;
    trial->builder = gen_builder(rng, options->faithful);
    trial->build.eps = trial->builder->faithful ? gen_eps(rng) : BUILD_EPS_DEFAULT;
    trial->box = gen_box_test(rng, options->faithful);
    trial->tri = gen_tri_test(rng, options->faithful);
    trial->query = rng_below(rng, 4) == 0 ? QUERY_ANY : QUERY_CLOSEST;
}

/* No edit in half of the trials, else one to three. */
static enum status edit(struct rng *rng, struct fuzz_trial *trial, struct reason *reason)
{
    uint32_t count = rng_below(rng, 2) ? 1 + rng_below(rng, 3) : 0;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < count && !status; i++)
        status = mutate_once(rng, trial, EDIT_SCENE, reason);
    return status;
}

static enum status make(uint64_t seed, uint64_t index, const struct gen_options *options,
                        struct fuzz_trial *out, struct reason *reason)
{
    struct rng rng = rng_of_trial(seed, index, false);
    const struct recipe *recipe = gen_recipe(&rng);
    uint32_t goal =
        recipe->goal ? recipe->goal(&rng)
                     : options->triangles_least +
                           rng_below(&rng, options->triangles_most - options->triangles_least + 1);
    struct sketch sketch;
    enum status status = fuzz_trial_make(3 * goal, goal, options->rays, out, reason);
    if (status)
        return status;
    draw(recipe, &rng, goal, out, &sketch);
    out->origin = (struct fuzz_origin){.seed = seed, .index = index, .version = GEN_VERSION};
    snprintf(out->origin.recipe, sizeof out->origin.recipe, "%s", recipe->name);
    if (!sketch.plain)
        status = edit(&rng, out, reason);
    if (status) {
        fuzz_trial_free(out);
        return status;
    }
    gen_choose_tests(&rng, options, sketch.leaf, out);
    out->build.presplit = gen_presplit(seed, index, out->builder);
    struct aim aim;
    aim_make(&out->scene, out->build.leaf, &rng, &aim);
    aim_rays(&aim, &rng, out->ray, out->ray_count);
    gen_steps(seed, index, options->steps, out);
    return STATUS_OK;
}

/* Half of the worlds are edited, by one to four edits. */
static enum status make_world(uint64_t seed, uint64_t index, const struct gen_options *options,
                              struct fuzz_trial *out, struct reason *reason)
{
    struct rng rng = rng_of_trial(seed, index, true);
    enum status status = gen_world_draw(&rng, options, out, reason);
    if (status)
        return status;
    out->origin.seed = seed;
    out->origin.index = index;
    out->origin.version = GEN_VERSION;
    uint32_t count = rng_below(&rng, 2) ? 1 + rng_below(&rng, 4) : 0;
    for (uint32_t i = 0; i < count && !status; i++)
        status = mutate_once(&rng, out, EDIT_SCENE, reason);
    gen_choose_tests(&rng, options, 0, out);
    out->build.presplit = gen_presplit(seed, index, out->builder);
    if (!status)
        status = gen_world_aim(&rng, out, reason);
    if (!status && options->steps)
        gen_steps(seed, index, true, out);
    if (status)
        fuzz_trial_free(out);
    return status;
}

enum status gen_trial(uint64_t seed, uint64_t index, const struct gen_options *options,
                      struct fuzz_trial *out, struct reason *reason)
{
    unsigned long environment = environment_enter(); /* a library may have left FTZ and DAZ */
    enum status status = options->worlds ? make_world(seed, index, options, out, reason)
                                         : make(seed, index, options, out, reason);
    environment_leave(environment);
    return status;
}
