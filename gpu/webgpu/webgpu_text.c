#include "gpu/webgpu/webgpu_text.h"

#include "gpu/trace/dispatch.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PARTS_MOST 10u

/* A layout with WGSL: its file, and those that it needs. */
struct shader_of {
    const char *layout;
    const char *part[3];
};

static const struct shader_of shaders_of[] = {
    {"f32", {"items.wgsl", "layout_f32.wgsl", "walk_two.wgsl"}},
    {"rf16", {"half.wgsl", "layout_rf16.wgsl", "walk_two.wgsl"}},
    {"rtrs_direct", {"layout_rtrs_direct.wgsl", "walk_two.wgsl", NULL}},
    {"rtrs_rf", {"half.wgsl", "layout_rtrs_rf.wgsl", "walk_two.wgsl"}},
    {"rtrs_rf_paper", {"half.wgsl", "layout_rtrs_rf_paper.wgsl", "walk_two.wgsl"}},
    {"cwbvh80", {"items.wgsl", "layout_cwbvh80.wgsl", "walk_wide.wgsl"}},
};

const char *wgsl_find(const char *name)
{
    for (size_t i = 0; wgsl_sources[i].name; i++)
        if (strcmp(wgsl_sources[i].name, name) == 0)
            return wgsl_sources[i].text;
    return NULL;
}

static const struct shader_of *find(const struct layout *layout)
{
    for (size_t i = 0; i < ARRAY_COUNT(shaders_of); i++)
        if (strcmp(shaders_of[i].layout, layout->name) == 0)
            return &shaders_of[i];
    return NULL;
}

bool webgpu_takes(const struct layout *layout)
{
    return find(layout) != NULL;
}

/* Joins `head` and the parts, up to a NULL. */
static enum status join(const char *head, const char *const part[PARTS_MOST], char **out,
                        struct reason *reason)
{
    size_t bytes = strlen(head) + 1;
    for (size_t i = 0; i < PARTS_MOST && part[i]; i++)
        bytes += strlen(wgsl_find(part[i]));
    *out = alloc_zeroed(bytes, 1);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "webgpu: no memory for a shader");
    text_append(*out, bytes, "%s", head);
    for (size_t i = 0; i < PARTS_MOST && part[i]; i++)
        text_append(*out, bytes, "%s", wgsl_find(part[i]));
    return STATUS_OK;
}

static enum status check(const struct job *job, uint32_t *stack, struct reason *reason)
{
    const struct packed *packed = job->packed;
    if (!webgpu_takes(packed->layout))
        return fail(reason, STATUS_UNSUPPORTED, "webgpu: layout %s has no WGSL",
                    packed->layout->name);
    if (packed->store->id != ABI_STORE_INDEXED)
        return fail(reason, STATUS_UNSUPPORTED, "webgpu: storage %s has no WGSL, only indexed",
                    packed->store->name);
    if (job->query == QUERY_ALL)
        return fail(reason, STATUS_UNSUPPORTED, "webgpu: it lists no hits, only closest and any");
    return dispatch_stack(packed->stack_need, layout_stack_most(packed->layout), stack, reason);
}

enum status webgpu_text(const struct job *job, char **out, struct reason *reason)
{
    uint32_t stack = 0;
    char head[800] = "";
    *out = NULL;
    enum status status = check(job, &stack, reason);
    if (status)
        return status;
    const struct {
        const char *name;
        uint32_t value;
    } constant[] = {{"BOX_RTRS", ABI_BOX_RTRS},
                    {"BOX_WATERTIGHT", ABI_BOX_WATERTIGHT},
                    {"TRI_MT_RTRS", ABI_TRI_MT_RTRS},
                    {"TRI_WOOP", ABI_TRI_WOOP},
                    {"TRI_PLUECKER", ABI_TRI_PLUECKER},
                    {"TRI_BALDWIN_WEBBER", ABI_TRI_BALDWIN_WEBBER},
                    {"QUERY_ANY", ABI_QUERY_ANY},
                    {"BOX_TEST", job->box->id},
                    {"TRI_TEST", job->tri->id},
                    {"QUERY", job->query},
                    {"STACK", stack}};
    for (size_t i = 0; i < ARRAY_COUNT(constant); i++)
        text_append(head, sizeof head, "const %s = %uu;\n", constant[i].name, constant[i].value);
    const struct shader_of *of = find(job->packed->layout);
    const char *const part[PARTS_MOST] = {"job.wgsl",   "node.wgsl", "slab.wgsl", "tri.wgsl",
                                          "stack.wgsl", "walk.wgsl", of->part[0], of->part[1],
                                          of->part[2],  NULL};
    return join(head, part, out, reason);
}

enum status webgpu_probe_text(char **out, struct reason *reason)
{
    static const char *const part[PARTS_MOST] = {"job.wgsl", "probe.wgsl"};
    return join("", part, out, reason);
}
