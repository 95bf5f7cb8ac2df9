#include "ref/engine.h"

#include "counts.h"

#include <string.h>

extern const struct engine engine_brute, engine_cpu, engine_vulkan, engine_vulkan_brute,
    engine_rayquery, engine_embree, engine_embree_robust;

const struct engine *const engines[] = {
    &engine_brute,    &engine_cpu,    &engine_vulkan,        &engine_vulkan_brute,
    &engine_rayquery, &engine_embree, &engine_embree_robust, NULL,
};

/* One file holds both Embree engines; every other file holds one. */
_Static_assert(ARRAY_COUNT(engines) - 1 == ENGINE_FILES + 1, "an engine_*.c is in no table");

const struct engine *engine_find(const char *name)
{
    for (size_t i = 0; engines[i]; i++)
        if (strcmp(engines[i]->name, name) == 0)
            return engines[i];
    return NULL;
}
