#include "ref/engine.h"

#include "ref/twin/model.h"

#include "counts.h"

#include <string.h>

extern const struct engine engine_brute, engine_cpu, engine_vulkan, engine_vulkan_brute,
    engine_rayquery, engine_embree, engine_embree_robust, engine_fast, engine_fast_small,
    engine_cpu_stackless, engine_vulkan_stackless, engine_webgpu, engine_kd, engine_dual_split;

/* Each engine_*.c holds one engine in the table, except engine_embree.c, which holds two. */
#define OWN (ENGINE_FILES + 1)

static const struct engine *table[OWN + ENGINES_ADDED_MOST + 1] = {
    &engine_brute,      &engine_cpu,           &engine_vulkan,           &engine_vulkan_brute,
    &engine_rayquery,   &engine_embree,        &engine_embree_robust,    &engine_fast,
    &engine_fast_small, &engine_cpu_stackless, &engine_vulkan_stackless, &engine_webgpu,
    &engine_kd,         &engine_dual_split,
};
static size_t count = OWN;
static struct engine added[ENGINES_ADDED_MOST];

/* Update the number when the table above changes. */
_Static_assert(OWN == 14, "an engine_*.c is in no table");

const struct engine *const *const engines = table;

enum status engine_add(const struct engine *engine, const struct engine **out,
                       struct reason *reason)
{
    if (count == OWN + ENGINES_ADDED_MOST)
        return fail(reason, STATUS_LIMIT, "%.80s: more than %d engines beside the program's own",
                    engine->name, ENGINES_ADDED_MOST);
    added[count - OWN] = *engine;
    *out = table[count] = &added[count - OWN];
    count++;
    return STATUS_OK;
}

struct model engine_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    return engine->model(engine, self, tri);
}

const struct engine *engine_reference(bool packed)
{
    return packed ? &engine_cpu : &engine_brute;
}

const struct engine *engine_find(const char *name)
{
    for (size_t i = 0; engines[i]; i++)
        if (strcmp(engines[i]->name, name) == 0)
            return engines[i];
    return NULL;
}
