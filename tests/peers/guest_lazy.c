/* A tracer that is honest while it may be judged and lazy while it may be timed, to race it: HONEST
 * is the object that it calls. LAZY 1: from the third call on all rays miss. LAZY 2: calls of over
 * 9000 rays. LAZY 3: it keeps the answers to the rays of its last call, and is told on when they
 * were of use. */
#include "ref/raydiff_engine.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct raydiff_engine *honest;
static size_t calls, kept_count, of_use;
static struct raydiff_engine_ray *kept_ray;
static struct raydiff_engine_hit *kept_hit;

static int lazy(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                struct raydiff_engine_hit *hit, char *reason)
{
    calls++;
    if ((LAZY == 1 && calls > 2) || (LAZY == 2 && count > 9000)) {
        for (size_t i = 0; i < count; i++)
            hit[i] = (struct raydiff_engine_hit){0, 0, 0, RAYDIFF_ENGINE_NONE};
        return RAYDIFF_ENGINE_OK;
    }
    if (LAZY == 3 && count == kept_count && memcmp(ray, kept_ray, count * sizeof *ray) == 0) {
        fprintf(stderr, "kept answers were of use %zu times\n", ++of_use);
        memcpy(hit, kept_hit, count * sizeof *hit);
        return RAYDIFF_ENGINE_OK;
    }
    const int status = honest->trace(self, ray, count, query, hit, reason);
    free(kept_ray);
    free(kept_hit);
    kept_count = count;
    kept_ray = malloc((count + 1) * sizeof *ray);
    kept_hit = malloc((count + 1) * sizeof *hit);
    if (!kept_ray || !kept_hit)
        return RAYDIFF_ENGINE_MEMORY;
    memcpy(kept_ray, ray, count * sizeof *ray);
    memcpy(kept_hit, hit, count * sizeof *hit);
    return status;
}

const struct raydiff_engine *raydiff_engine(void)
{
    static struct raydiff_engine table;
    void *object = dlopen(HONEST, RTLD_NOW);
    void *found = object ? dlsym(object, "raydiff_engine") : NULL;
    const struct raydiff_engine *(*make)(void);
    memcpy(&make, &found, sizeof make);
    if (!found)
        return NULL;
    honest = make();
    table = *honest;
    table.name = "lazy";
    table.trace = lazy;
    return &table;
}
