#include "cmd/common/cmd_use.h"

#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "scenes/rays/rays.h"
#include "scenes/worlds.h"
#include "ref/store.h"

#include <string.h>

bool option_among(const char *names, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = names; *at; at += strcspn(at, " ")) {
        at += strspn(at, " ");
        if (strncmp(at, name, length) == 0 && (at[length] == ' ' || at[length] == '\0'))
            return true;
    }
    return false;
}

/* --- what options need ------------------------------------------------------------------------ */

static bool is_gpu(const struct engine *engine)
{
    return engine->gpu;
}

bool engine_is_peer(const struct engine *engine)
{
    return pipe_is_peer(engine->name);
}

static bool is_guest(const struct engine *engine)
{
    return object_of_engine(engine->name) != NULL;
}

static bool is_of_processor(const struct engine *engine)
{
    return !engine->gpu && (!engine_is_peer(engine) || is_guest(engine));
}

static bool is_of_shaders(const struct engine *engine)
{
    return engine->gpu && engine->needs_packed;
}

static bool walks_trees(const struct engine *engine)
{
    return engine->needs_packed;
}

static bool tests_ours(const struct engine *engine)
{
    return !engine->own_tri;
}

/* True for engines whose formula is unknown. */
static bool is_black(const struct engine *engine)
{
    return engine_is_peer(engine) || is_guest(engine) || (engine->gpu && engine->own_tri);
}

static bool any_engine(const struct option_use *use, bool (*is)(const struct engine *engine))
{
    bool any = !use->engine;
    for (size_t i = 0; use->engine && i < use->engine->count; i++)
        any = any || is(engines[use->engine->index[i]]);
    return any;
}

static bool on_shaders(const struct option_use *use, const char *option)
{
    (void)option;
    return use->compares || any_engine(use, is_of_shaders);
}

/* Has a process of its own. */
static bool has_peer(const struct engine *engine)
{
    return engine->fault != NULL;
}

static bool from_outside(const struct option_use *use, const char *option)
{
    (void)option;
    bool any = any_engine(use, use->unnamed ? engine_is_peer : has_peer);
    for (size_t i = 0; use->layout && i < use->layout->count; i++)
        any = any || layouts_all[use->layout->index[i]]->outside;
    return any;
}

/* An engine or a builder. */
static bool on_vulkan(const struct option_use *use, const char *option)
{
    (void)option;
    bool any = any_engine(use, is_gpu);
    for (size_t i = 0; use->builder && i < use->builder->count; i++)
        any = any || builders_all[use->builder->index[i]]->compare != NULL;
    return any;
}

static bool by_builder(const struct option_use *use, const char *option)
{
    bool any = !use->builder;
    for (size_t i = 0; use->builder && i < use->builder->count; i++) {
        any = any || builder_takes(builders_all[use->builder->index[i]], option);
    }
    return any;
}

static bool of_lossy(const struct option_use *use, const char *option)
{
    (void)option;
    bool any = !use->store;
    for (size_t i = 0; use->store && i < use->store->count; i++)
        any = any || tri_stores[use->store->index[i]]->lossy != NULL;
    return any;
}

/* True if the scene depends on --seed. Files do not, nor generators that draw no random numbers,
 * nor a text that gives its own seed. */
static bool scene_is_seeded(const char *spec)
{
    char name[64];
    const char *colon = strchr(spec, ':');
    snprintf(name, sizeof name, "%.*s", (int)strcspn(spec, ":"), spec);
    const struct generator *generator = generator_find(name);
    const struct world_generator *of_worlds = world_generator_find(name);
    if (generator ? generator->seedless : !of_worlds || of_worlds->seedless)
        return false;
    return !colon || (!strstr(colon, ":seed=") && !strstr(colon, ",seed="));
}

static bool by_chance(const struct option_use *use, const char *option)
{
    (void)option;
    bool any = use->seeded || (!use->rays && !use->scene);
    for (size_t i = 0; use->rays && i < use->rays->count; i++)
        any = any || !ray_sets[use->rays->index[i]]->seedless;
    for (size_t i = 0; use->scene && i < use->scene_count; i++)
        any = any || scene_is_seeded(use->scene[i]);
    return any;
}

static const struct {
    const char *options;
    const char *what;
    bool (*is)(const struct engine *engine); /* true for one engine of the run; NULL: see is_met */
    bool (*is_met)(const struct option_use *use, const char *option);
} needs[] = {
    {"layout store builder box leaf eps bvh braid bins radius split-budget split-alpha presplit "
     "optimize",
     "an engine that walks trees", walks_trees, NULL},
    {"eps bins radius split-budget split-alpha presplit", "builder", NULL, by_builder},
    {"tri", "an engine that has no triangle test of its own", tests_ours, NULL},
    {"workgroup", "an engine on Vulkan", is_gpu, NULL},
    {"driver device", "an engine or a builder on Vulkan", NULL, on_vulkan},
    {"shader", "an engine that runs shaders of layouts", NULL, on_shaders},
    {"displacement", "an engine whose formula is not known", is_black, NULL},
    {"threads", "an engine of the processor", is_of_processor, NULL},
    {"peer-time peer-memory", "pipe:COMMAND, --engine webgpu or FILE.so, or --layout FILE.so", NULL,
     from_outside},
    {"bits", "--store quantised, truncated or dgf1", NULL, of_lossy},
    {"seed", "a scene or rays that are drawn by chance", NULL, by_chance},
};

/* Appends the names of the builders that take an option. */
static void name_builders(const char *option, char *text, size_t text_bytes)
{
    for (size_t i = 0; builders_all[i]; i++)
        if (builder_takes(builders_all[i], option))
            text_append(text, text_bytes, " %s", builders_all[i]->name);
}

bool option_is_used(const struct option_use *use, const char *option, struct reason *why)
{
    char text[200];
    const bool left_out = (use->only && !option_among(use->only, option)) ||
                          (use->never && option_among(use->never, option));
    if (left_out) {
        (void)fail(why, STATUS_INPUT, "--%s: not used by %s", option, use->by);
        return false;
    }
    for (size_t i = 0; i < ARRAY_COUNT(needs); i++) {
        if (!option_among(needs[i].options, option) ||
            (needs[i].is ? any_engine(use, needs[i].is) : needs[i].is_met(use, option)))
            continue;
        snprintf(text, sizeof text, "%s", needs[i].what);
        if (needs[i].is_met == by_builder)
            name_builders(option, text, sizeof text);
        (void)fail(why, STATUS_INPUT, "--%s: not used here: it needs %s", option, text);
        return false;
    }
    return true;
}

enum status options_check(const struct option_use *use, struct reason *reason)
{
    const char *option;
    for (size_t i = 0; (option = option_given(i)) != NULL; i++)
        if (!option_is_used(use, option, reason))
            return STATUS_INPUT;
    return STATUS_OK;
}

int options_refused(const char *command, const struct option_use *use)
{
    struct reason reason;
    return options_check(use, &reason) ? usage_error(command, "%s", reason.text) : -1;
}
