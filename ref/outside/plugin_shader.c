#include "ref/outside/plugin_shader.h"

#include "ref/outside/plugin_guard.h"
#include "ref/base/command.h"

#include <string.h>

static plugin_compile_fn *compile_with;
static const char *waiting;          /* a file that came before its layout */
static const struct layout *without; /* the last layout, if it has no file yet */
static const struct layout *named;   /* the last layout */

static struct {
    const struct layout *layout;
    const char *file;
} bound[LAYOUTS_ADDED_MOST];
static size_t bound_count;

void plugin_compile_with(plugin_compile_fn *compile)
{
    compile_with = compile;
}

static enum status bind(const struct layout *layout, const char *file, struct reason *reason)
{
    if (!compile_with)
        return fail(reason, STATUS_INPUT, "--shader: this program compiles none");
    if (bound_count == ARRAY_COUNT(bound))
        return fail(reason, STATUS_LIMIT, "--shader: more than %zu files", ARRAY_COUNT(bound));
    enum status status = compile_with(layout, file, reason);
    if (status)
        return status;
    bound[bound_count].layout = layout;
    bound[bound_count++].file = file;
    waiting = NULL;
    without = NULL;
    return STATUS_OK;
}

/* A command run by another command gets the same options again. */
static bool is_bound(const struct layout *layout, const char *file)
{
    const char *path = layout && file ? plugin_shader_path(layout) : NULL;
    return path && strcmp(path, file) == 0;
}

enum status plugin_shader_take(const char *file, struct reason *reason)
{
    if (is_bound(named, file))
        return STATUS_OK;
    if (without)
        return bind(without, file, reason);
    if (waiting)
        return fail(reason, STATUS_INPUT,
                    "--shader: '%.60s' and '%.60s': each needs a --layout FILE.so", waiting, file);
    waiting = file;
    return STATUS_OK;
}

enum status plugin_shader_layout(const struct layout *layout, struct reason *reason)
{
    named = layout;
    if (is_bound(layout, waiting))
        waiting = NULL;
    if (plugin_shader_path(layout))
        return STATUS_OK;
    without = layout;
    return waiting ? bind(layout, waiting, reason) : STATUS_OK;
}

enum status plugin_shader_settle(struct reason *reason)
{
    if (!waiting)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "--shader: '%.120s' needs a --layout FILE.so to go with",
                waiting);
}

const char *plugin_shader_path(const struct layout *layout)
{
    for (size_t i = 0; i < bound_count; i++)
        if (bound[i].layout == layout)
            return bound[i].file;
    return NULL;
}

const char *plugin_shader_of(const char *path)
{
    for (size_t i = 0; i < bound_count; i++) {
        const char *object = plugin_path(bound[i].layout);
        if (object && strcmp(object, path) == 0)
            return bound[i].file;
    }
    return NULL;
}

void plugin_command(char *text, size_t text_bytes, const struct layout *layout)
{
    const char *path = plugin_path(layout), *shader = plugin_shader_path(layout);
    command_word(text, text_bytes, "--layout");
    command_word(text, text_bytes, path ? path : layout->name);
    if (shader) {
        command_word(text, text_bytes, "--shader");
        command_word(text, text_bytes, shader);
    }
}
