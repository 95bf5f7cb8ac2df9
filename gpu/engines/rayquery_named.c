#include "gpu/engines/rayquery_named.h"

#include "gpu/engines/rayquery_build.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

extern const struct engine engine_rayquery;

/* An engine of this file. */
struct variant_place {
    char name[ACCEL_NAME_MOST];
    struct accel_variant variant;
};

static struct variant_place places[ENGINES_RAYQUERY_MOST];
static struct engine engine_of[ENGINES_RAYQUERY_MOST];
static size_t place_count;

/* One function for each place, as an engine is not told its name when it is opened. */
#define ROW(each, h)                                                                               \
    each(0x##h##0) each(0x##h##1) each(0x##h##2) each(0x##h##3) each(0x##h##4) each(0x##h##5)      \
        each(0x##h##6) each(0x##h##7) each(0x##h##8) each(0x##h##9) each(0x##h##A) each(0x##h##B)  \
            each(0x##h##C) each(0x##h##D) each(0x##h##E) each(0x##h##F)
#define PLACES(each)                                                                               \
    ROW(each, 0)                                                                                   \
    ROW(each, 1) ROW(each, 2) ROW(each, 3) ROW(each, 4) ROW(each, 5) ROW(each, 6) ROW(each, 7)

#define OPEN(n)                                                                                    \
    static enum status open_##n(const struct engine_options *options, void **self,                 \
                                struct reason *reason)                                             \
    {                                                                                              \
        return rayquery_open(options, &places[n].variant, self, reason);                           \
    }
PLACES(OPEN)

#define NAME_OF_OPEN(n) open_##n,
static enum status (*const opens[])(const struct engine_options *options, void **self,
                                    struct reason *reason) = {PLACES(NAME_OF_OPEN)};
_Static_assert(ARRAY_COUNT(opens) == ENGINES_RAYQUERY_MOST, "a function for each place");

static enum status add(const struct accel_variant *variant, const char *name,
                       const struct engine **out, struct reason *reason)
{
    struct accel_variant original;
    const struct engine *plain = &engine_rayquery;
    const bool copy = accel_original(variant, &original);
    char own[ACCEL_NAME_MOST];
    accel_write(&original, own);
    enum status status =
        copy && !rayquery_is_plain(&original) ? rayquery_named(own, &plain, reason) : STATUS_OK;
    if (status)
        return status;
    if (place_count == ENGINES_RAYQUERY_MOST)
        return fail(reason, STATUS_LIMIT, "%.80s: more than %d variants of rayquery", name,
                    ENGINES_RAYQUERY_MOST);
    struct variant_place *place = &places[place_count];
    struct engine *engine = &engine_of[place_count];
    snprintf(place->name, sizeof place->name, "%s", name);
    place->variant = *variant;
    *engine = engine_rayquery;
    engine->plain = plain;
    engine->plain_bits = copy;
    engine->name = place->name;
    engine->summary = "a variant of rayquery";
    engine->open = opens[place_count];
    engine->move = variant->how.update != VK_ACCEL_UPDATE_NONE ? rayquery_move : NULL;
    if (variant->split) /* the geometries of a world are its own */
        engine->worlds = NULL;
    status = engine_add(engine, reason);
    if (status)
        return status;
    place_count++;
    *out = engine;
    return STATUS_OK;
}

enum status rayquery_named(const char *name, const struct engine **out, struct reason *reason)
{
    struct accel_variant variant;
    char own[ACCEL_NAME_MOST];
    *out = NULL;
    enum status status = accel_parse(name, &variant, reason);
    if (status)
        return status;
    accel_write(&variant, own);
    *out = engine_find(own);
    return *out ? STATUS_OK : add(&variant, own, out, reason);
}

enum status rayquery_named_all(const char *pattern, struct reason *reason)
{
    enum status status = STATUS_OK;
    bool any = false;
    for (size_t i = 0; accel_names[i] && !status; i++) {
        const struct engine *engine;
        if (fnmatch(pattern, accel_names[i], 0) != 0)
            continue;
        any = true;
        status = rayquery_named(accel_names[i], &engine, reason);
    }
    if (!any)
        return fail(reason, STATUS_INPUT, "no variant of rayquery is called '%.60s'", pattern);
    return status;
}

const struct accel_variant *rayquery_variant_of(const struct engine *engine)
{
    for (size_t i = 0; i < place_count; i++)
        if (&engine_of[i] == engine)
            return &places[i].variant;
    return NULL;
}
