#include "gpu/shaders/shaders.h"

#include "gpu/shaders/spirv_fix.h"
#include "gpu/shaders/spirv_look.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Shaders of plugin layouts. They live until the program ends. */
static struct shader added[SHADERS_ADDED_MOST];
static char added_name[SHADERS_ADDED_MOST][64];
static size_t added_count;

static struct {
    char layout[48];
    struct reason why;
} lacking[SHADERS_ADDED_MOST];
static size_t lacking_count;

const struct shader *shader_find(const char *name)
{
    for (const struct shader *shader = shaders; shader->name; shader++)
        if (strcmp(shader->name, name) == 0)
            return shader;
    for (size_t i = 0; i < added_count; i++)
        if (strcmp(added[i].name, name) == 0)
            return &added[i];
    return NULL;
}

/* Checks the decorated module. A test checks the embedded ones; added ones are checked here. */
static enum status look_through(const char *file, const uint32_t *word, uint32_t count,
                                struct reason *reason)
{
    struct spirv_found found;
    enum status status = spirv_look(word, count, &found, reason);
    if (!status && found.bare)
        status =
            fail(reason, STATUS_INTERNAL, "%.120s: %u of %u float operations without NoContraction",
                 file, found.bare, found.float_ops);
    return status;
}

enum status shader_add(const char *layout, enum glsl_use use, const char *file,
                       const uint32_t *word, size_t count, struct reason *reason)
{
    struct reason why = {""};
    static const char *const prefix[GLSL_USES] = {
        [GLSL_TRACE] = "trace", [GLSL_RENDER] = "render", [GLSL_DECODE] = "decode"};
    const bool render = use == GLSL_RENDER;
    const struct spirv_rules rules = {.tracing = !render, .render = render};
    uint32_t *fixed;
    size_t fixed_count;
    if (added_count == SHADERS_ADDED_MOST)
        return fail(reason, STATUS_LIMIT, "%.120s: more than %d shaders from outside", file,
                    SHADERS_ADDED_MOST);
    enum status status = spirv_fix(word, count, &rules, &fixed, &fixed_count, &why);
    if (status)
        return fail(reason, status, "%.120s: %s", file, why.text);
    status = look_through(file, fixed, (uint32_t)fixed_count, reason);
    if (status) {
        free(fixed);
        return status;
    }
    snprintf(added_name[added_count], sizeof added_name[0], "%s_%.48s", prefix[use], layout);
    added[added_count] = (struct shader){.name = added_name[added_count],
                                         .word = fixed,
                                         .word_count = (uint32_t)fixed_count,
                                         .tracing = !render};
    added_count++;
    return STATUS_OK;
}

void shader_lacks(const char *layout, const char *why)
{
    if (lacking_count == SHADERS_ADDED_MOST)
        return;
    snprintf(lacking[lacking_count].layout, sizeof lacking[0].layout, "%s", layout);
    (void)fail(&lacking[lacking_count++].why, STATUS_UNSUPPORTED, "%s", why);
}

void shader_why_not(const char *layout, struct reason *reason)
{
    for (size_t i = 0; i < lacking_count; i++)
        if (strcmp(lacking[i].layout, layout) == 0) {
            (void)fail(reason, STATUS_UNSUPPORTED, "vulkan: %s", lacking[i].why.text);
            return;
        }
    (void)fail(reason, STATUS_UNSUPPORTED, "vulkan: there is no shader for layout %s", layout);
}
