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
    struct world_tracer worlds;
};

static enum status variant_open(const struct engine *engine, const struct engine_options *options,
                                void **self, struct reason *reason)
{
    return rayquery_open(options, rayquery_variant_of(engine), self, reason);
}

static enum status add(const struct accel_variant *variant, const char *name,
                       const struct engine **out, struct reason *reason)
{
    static struct variant_place places[ENGINES_RAYQUERY_MOST];
    static size_t place_count;
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
    snprintf(place->name, sizeof place->name, "%s", name);
    place->variant = *variant;
    struct engine engine = engine_rayquery;
    engine.plain = plain;
    engine.plain_bits = copy;
    engine.name = place->name;
    engine.summary = "a variant of rayquery";
    engine.named = &place->variant;
    engine.open = variant_open;
    const bool updates = variant->how.update != VK_ACCEL_UPDATE_NONE;
    engine.move = updates ? rayquery_move : NULL;
    place->worlds = *engine_rayquery.worlds;
    place->worlds.move_world = updates ? rayquery_move_world : NULL;
    engine.worlds =
        variant->split ? NULL : &place->worlds; /* the geometries of a world are its own */
    status = engine_add(&engine, out, reason);
    place_count += !status;
    return status;
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
    return engine->open == variant_open ? engine->named : NULL;
}
