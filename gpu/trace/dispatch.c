#include "gpu/trace/dispatch.h"
#include "ref/store.h"

#include <stdio.h>

enum status dispatch_stack(uint32_t need, uint32_t most, uint32_t *out, struct reason *reason)
{
    *out = 16;
    if (need > most)
        return fail(reason, STATUS_LIMIT, "vulkan: stacks of %u entries, the tree needs %u", most,
                    need);
    while (*out < need)
        *out *= 2;
    return STATUS_OK;
}

enum status dispatch_tree(const struct job *job, uint32_t workgroup, struct dispatch *out,
                          struct reason *reason)
{
    const struct packed *packed = job->packed;
    char name[64];
    const struct layout *layout = packed->layout;
    snprintf(name, sizeof name, "%s_%s", job->parent ? "stackless" : "trace",
             layout_shader(layout));
    *out = (struct dispatch){
        .shader = shader_find(name),
        .constant = {[ABI_SPEC_WORKGROUP] = workgroup,
                     [ABI_SPEC_BOX] = job->box->id,
                     [ABI_SPEC_TRI] = job->tri->id,
                     [ABI_SPEC_QUERY] = job->query,
                     [ABI_SPEC_STORE] = packed->store->id,
                     [ABI_SPEC_LAYOUT_0] = layout->constant[0],
                     [ABI_SPEC_LAYOUT_1] = layout->constant[1]},
        .push = {.root = packed->root,
                 .node_count = packed->ref_count,
                 .item_count = packed->item_count,
                 .tri_count = job->scene->tri_count,
                 .capacity = 1},
    };
    enum status status = dispatch_stack(packed->stack_need, layout_stack_most(layout),
                                        &out->constant[ABI_SPEC_STACK], reason);
    if (!status)
        status = tri_store_check(packed->store, job->tri->id, job->tri->name, reason);
    if (!status && !out->shader) {
        shader_why_not(layout->name, reason);
        status = STATUS_UNSUPPORTED;
    }
    return status;
}

struct push dispatch_brute_push(uint32_t tri_count, uint32_t first)
{
    uint32_t left = tri_count - first;
    return (struct push){.root = first,
                         .node_count = first + (left < DISPATCH_PART ? left : DISPATCH_PART),
                         .tri_count = tri_count,
                         .capacity = 1};
}

struct dispatch dispatch_brute(const struct job *job, uint32_t workgroup)
{
    return (struct dispatch){
        .shader = shader_find("trace_brute"),
        .constant = {[ABI_SPEC_WORKGROUP] = workgroup,
                     [ABI_SPEC_BOX] = ABI_BOX_ROBUST,
                     [ABI_SPEC_TRI] = job->tri->id,
                     [ABI_SPEC_QUERY] = job->query,
                     [ABI_SPEC_STACK] = 16},
        .push = dispatch_brute_push(job->scene->tri_count, 0),
    };
}

struct dispatch dispatch_query(const struct job *job, uint32_t workgroup)
{
    return (struct dispatch){
        .shader = shader_find("query_rays"),
        .constant = {[ABI_SPEC_WORKGROUP] = workgroup,
                     [ABI_SPEC_BOX] = ABI_BOX_ROBUST,
                     [ABI_SPEC_TRI] = ABI_TRI_MT,
                     [ABI_SPEC_QUERY] = job->query,
                     [ABI_SPEC_STACK] = 16},
        .push = {.capacity = 1},
        .accel = true,
    };
}

uint32_t dispatch_groups(const struct dispatch *dispatch, uint32_t ray_count)
{
    uint32_t workgroup = dispatch->constant[ABI_SPEC_WORKGROUP];
    return (uint32_t)(((uint64_t)ray_count + workgroup - 1) / workgroup);
}

struct vk_shader dispatch_shader(const struct dispatch *dispatch)
{
    return (struct vk_shader){
        .name = dispatch->shader->name,
        .word = dispatch->shader->word,
        .word_count = dispatch->shader->word_count,
        .binding_count = DISPATCH_BINDINGS,
        .push_bytes = sizeof(struct push),
        .accel = dispatch->accel,
        .constant = dispatch->constant,
        .constant_count = DISPATCH_CONSTANTS,
    };
}

const char *dispatch_cause(uint32_t flag)
{
    if (flag & ABI_FLAG_STACK)
        return "its traversal stack overran: the tree is deeper than its stack_need says";
    if (flag & ABI_FLAG_VISITS)
        return "it visited more nodes than there are: the tree has a cycle";
    if (flag & ABI_FLAG_LOOP)
        return "the driver ended its loop early (lavapipe 22 does after 65,535 iterations)";
    return "its invocation did not run to the end";
}
