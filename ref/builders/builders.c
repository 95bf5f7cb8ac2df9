#include "ref/build/links.h"
#include "ref/build/presplit.h"
#include "ref/builders/reinsert.h"
#include "ref/builders/rotate.h"
#include "ref/tree/bvh.h"
#include "ref/base/memory.h"

#include "counts.h"

#include <math.h>
#include <string.h>

extern const struct builder build_median, build_rtrs, build_sah_binned, build_sah_sweep, build_lbvh,
    build_ploc, build_sbvh, build_trbvh, build_ploctree, build_lbvh30, build_lbvh63, build_hploc;

#define CORE &build_median, &build_rtrs

const struct builder *const builders[] = {CORE, NULL};

#define OWN                                                                                        \
    CORE, &build_sah_binned, &build_sah_sweep, &build_lbvh, &build_ploc, &build_sbvh,              \
        &build_trbvh, &build_ploctree, &build_lbvh30, &build_lbvh63, &build_hploc
#define OWN_COUNT     ARRAY_COUNT(((const struct builder *const[]){OWN}))
#define MORE_OF_FILES 1 /* build_karras.c has two */
_Static_assert(OWN_COUNT - MORE_OF_FILES == BUILDER_FILES, "a ref/builders/build_*.c has no entry");

static const struct builder *all[OWN_COUNT + BUILDERS_ADDED_MOST + 1] = {OWN};
static size_t added;

const struct builder *const *const builders_all = all;

enum status builder_add(const struct builder *builder, struct reason *reason)
{
    if (builder_find(builder->name))
        return fail(reason, STATUS_INPUT, "there is a builder '%s' already", builder->name);
    if (added == BUILDERS_ADDED_MOST)
        return fail(reason, STATUS_LIMIT, "%s: more than %d builders beside the program's own",
                    builder->name, BUILDERS_ADDED_MOST);
    all[OWN_COUNT + added++] = builder;
    return STATUS_OK;
}

const struct builder *builder_find(const char *name)
{
    for (size_t i = 0; builders_all[i]; i++)
        if (strcmp(builders_all[i]->name, name) == 0)
            return builders_all[i];
    return NULL;
}

bool builder_takes(const struct builder *builder, const char *option)
{
    size_t length = strlen(option);
    for (const char *at = builder->takes ? builder->takes : ""; *at; at += strspn(at, " ")) {
        size_t word = strcspn(at, " ");
        if (word == length && strncmp(at, option, length) == 0)
            return true;
        at += word;
    }
    return false;
}

#define GIGA           1000000000.0
#define REINSERT_BYTES 310u /* least memory of tree_reinsert, as tri_bytes */
#define ROTATE_BYTES   295u /* of tree_rotate */

uint64_t bvh_build_bytes(const struct builder *builder, uint32_t tri_count,
                         const struct build_options *options)
{
    double items = tri_count;
    float budget = options->split_budget == 0 ? BUILD_SPLIT_BUDGET_DEFAULT : options->split_budget;
    if (builder == &build_sbvh && budget > 0)
        items += items * fmin((double)budget, (double)BUILD_SPLIT_BUDGET_MOST);
    if (builder_takes(builder, "presplit"))
        items = presplit_most(tri_count, options);
    uint64_t build = (uint64_t)(items * builder->tri_bytes);
    if (builder == &build_median && options->presplit > 0) /* holds the parts until the end */
        build += (uint64_t)items * sizeof(struct part);
    uint64_t change = (uint64_t)(options->rotates ? ROTATE_BYTES : REINSERT_BYTES) * tri_count;
    return options->passes > 0 && change > build ? change : build;
}

static enum status may_build(const struct builder *builder, const struct scene *scene,
                             const struct build_options *options, struct reason *reason)
{
    uint64_t bytes = bvh_build_bytes(builder, scene->tri_count, options);
    if (memory_fits(bytes))
        return STATUS_OK;
    return fail(reason, STATUS_MEMORY,
                "builder %s: no memory: a tree of %u triangles takes at least %.1f GB, %.1f GB are "
                "free",
                builder->name, scene->tri_count, (double)bytes / GIGA,
                (double)memory_left() / GIGA);
}

enum status bvh_build(const struct builder *builder, const struct scene *scene,
                      const struct build_options *options, struct bvh *out, struct reason *reason)
{
    struct build_options single = *options;
    *out = (struct bvh){0};
    enum status status = may_build(builder, scene, options, reason);
    if (status)
        return status;
    if (options->passes == 0)
        return builder->build(scene, options, out, reason);
    if (builder->faithful)
        return fail(reason, STATUS_INPUT, "builder %s builds as published: it is not optimized",
                    builder->name);
    single.leaf = options->leaf > 0;
    status = builder->build(scene, &single, out, reason);
    if (status || out->node_count == 0)
        return status;
    status = options->rotates ? tree_rotate(out, options->passes, options->threads)
                              : tree_reinsert(out, options->passes, options->threads);
    if (!status && options->presplit > 0 && builder_takes(builder, "presplit"))
        status = presplit_merge(out, out->tri_count);
    if (!status)
        status = tree_collapse(out, options->leaf);
    if (status) {
        tree_drop(out);
        (void)fail(reason, status, "no memory to optimize a tree of %u triangles",
                   scene->tri_count);
    }
    return status;
}
