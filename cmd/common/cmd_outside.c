#include "cmd/common/cmd_outside.h"

#include "gpu/engines/compiled.h"
#include "gpu/engines/rayquery_named.h"
#include "gpu/engines/shader_tracer.h"
#include "ref/engines/embree_named.h"
#include "ref/guest/guest.h"
#include "ref/guest/guest_engine.h"
#include "ref/outside/pipe.h"
#include "ref/outside/plugin_guard.h"
#include "ref/outside/plugin_shader.h"
#include "ref/outside/recorded.h"
#include "ref/outside/shared_object.h"

#include <stdio.h>
#include <string.h>

static bool begins_with(const char *text, const char *prefix)
{
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

size_t outside_name_length(enum table table, const char *text)
{
    if (table != TABLE_ENGINES || !begins_with(text, PIPE_PREFIX))
        return strcspn(text, ",");
    const char *next = strstr(text, "," PIPE_PREFIX);
    return next ? (size_t)(next - text) : strlen(text);
}

bool outside_is_engine(const char *name)
{
    return pipe_is_peer(name) || file_of_engine(name) || outside_is_known(name);
}

bool outside_is_known(const char *name)
{
    return compiled_base(name) || embree_is_named(name) || accel_is_named(name);
}

enum status outside_engine(const char *name, const struct engine **out, struct reason *reason)
{
    const char *path = object_of_engine(name);
    *out = engine_find(name);
    if (*out)
        return STATUS_OK;
    if (begins_with(name, SHADER_PREFIX))
        return shader_tracer(name, out, reason);
    if (embree_is_named(name))
        return embree_named(name, out, reason);
    if (accel_is_named(name))
        return rayquery_named(name, out, reason);
    if (compiled_base(name))
        return compiled_engine(name, out, reason);
    enum status status = path ? guest_try(path, GUEST_TRY_MS, reason) : STATUS_OK;
    if (status)
        return status;
    return path && path != name ? guest_engine(name, out, reason) : pipe_engine(name, out, reason);
}

/* Engines whose modes are named by words. */
static const struct family {
    const char *prefix, *pattern; /* of all */
    enum status (*one)(const char *name, const struct engine **out, struct reason *reason);
    enum status (*all)(const char *pattern, struct reason *reason);
} families[] = {
    {EMBREE_PREFIX, EMBREE_PREFIX "*", embree_named, embree_named_all},
    {ACCEL_PREFIX, ACCEL_PREFIX "*", rayquery_named, rayquery_named_all},
};

/* Adds a mode of a family, or all of a pattern, and replaces the name by the engine's, or the
 * pattern. */
static enum status add_mode(const char *name, const char **text, size_t *length,
                            struct reason *reason)
{
    const struct family *family = &families[accel_is_named(name)];
    const struct engine *engine;
    const bool all = strcmp(name + strlen(family->prefix), "all") == 0;
    enum status status = STATUS_OK;
    if (!all && !strpbrk(name, "*?")) {
        status = family->one(name, &engine, reason);
        if (status)
            return status;
        *text = engine->name;
        *length = strlen(*text);
        return STATUS_OK;
    }
    if (all) {
        *text = family->pattern;
        *length = strlen(*text);
        name = *text;
    }
    return family->all(name, reason);
}

/* If the name is "pipe:COMMAND", "FILE.so", "inside:FILE.so", "shader:FILE", "ENGINE:COMPILER",
 * "embree:MODE", "rayquery:VARIANT" or "answer:...", adds that engine to the table. */
static enum status add_engine(enum table table, const char *flag, const char **text, size_t *length,
                              struct reason *reason)
{
    char name[PIPE_NAME_MOST + 1];
    const struct engine *engine;
    struct reason why = {""};
    enum status status = STATUS_OK;
    if (table != TABLE_ENGINES)
        return STATUS_OK;
    snprintf(name, sizeof name, "%.*s", (int)(*length < PIPE_NAME_MOST ? *length : PIPE_NAME_MOST),
             *text);
    const bool is_pipe = begins_with(name, PIPE_PREFIX);
    const char *comma = is_pipe ? pipe_engines_behind(name) : NULL;
    if (comma)
        status = fail(&why, STATUS_INPUT,
                      "'%.100s': a pipe takes all that follows as its command: name it last, as "
                      "'%.60s,%.*s', or quote the comma of the command",
                      name, comma + 1, (int)(comma - name < 90 ? comma - name : 90), name);
    else if (embree_is_named(name) || accel_is_named(name))
        status = add_mode(name, text, length, &why);
    else if (outside_is_engine(name))
        status = outside_engine(name, &engine, &why);
    else if (begins_with(name, RECORDED_PREFIX))
        status = recorded_find(name, &engine, &why);
    if (status == STATUS_DEVICE || status == STATUS_UNSUPPORTED)
        return fail(reason, status, "%s: %s", flag, why.text);
    return status ? fail(reason, STATUS_INPUT, "%s: %s", flag, why.text) : STATUS_OK;
}

/* If the name is "PATH.so", adds that layout to the table and replaces the name by the layout's. */
static enum status add_plugin(enum table table, const char *flag, const char **text, size_t *length,
                              struct reason *reason)
{
    char path[512];
    const struct layout *layout;
    struct reason why = {""};
    if (table != TABLE_LAYOUTS || !object_is_named(*text, *length) || *length >= sizeof path)
        return STATUS_OK;
    snprintf(path, sizeof path, "%.*s", (int)*length, *text);
    enum status status = plugin_open(path, &layout, &why);
    if (!status && plugin_shader_layout(layout, &why)) /* of a shader that was named before */
        return fail(reason, STATUS_INPUT, "--shader: %s", why.text);
    if (status)
        return fail(reason, status, "%s: %s", flag, why.text);
    *text = layout->name;
    *length = strlen(layout->name);
    return STATUS_OK;
}

enum status outside_add(enum table table, const char *flag, const char **text, size_t *length,
                        struct reason *reason)
{
    enum status status = add_engine(table, flag, text, length, reason);
    return status ? status : add_plugin(table, flag, text, length, reason);
}
