#include "gpu/frame/frame_dispatch.h"

#include "gpu/trace/dispatch.h"

#include <stdio.h>

/* lavapipe 22 ends loops after this many iterations of all loops of an invocation. */
#define LOOPS_MOST 65535u

/* The most iterations of a ray whose box test may not cull: every node is visited, pushed and
 * popped, and every leaf is read slot by slot (8 slots in a leaf of RTRS's records, which are three
 * a leaf). 0 for other box tests, which cull; if a loop still ends early, the shader's flags report
 * it. */
static uint64_t steps_of_ray(const struct frame_job *job, bool brute)
{
    if (brute)
        return job->job.scene->tri_count;
    if (job->job.box->id != ABI_BOX_RTRS)
        return 0;
    return 4ull * job->job.packed->ref_count + job->job.packed->item_count;
}

static uint64_t rays_of_path(const struct frame_job *job)
{
    return (uint64_t)job->look.bounces * (1 + job->light_count);
}

static enum frame_plan plan_of(const struct frame_job *job, bool brute)
{
    if (job->look.bounces == 0) /* there are no steps */
        return FRAME_WHOLE;
    if (job->plan != FRAME_AUTO)
        return job->plan;
    return (steps_of_ray(job, brute) + 2) * rays_of_path(job) < LOOPS_MOST ? FRAME_WHOLE
                                                                           : FRAME_STEPS;
}

static uint32_t look_of(const struct frame_job *job)
{
    uint32_t look = job->look.camera_light > 0 ? ABI_LOOK_EYE : 0;
    if (job->look.ambience > 0)
        look |= ABI_LOOK_AMBIENCE;
    if (job->look.profile == PROFILE_RTRS) /* it continues paths at any reflectivity */
        look |= ABI_LOOK_REFLECT;
    for (uint32_t i = 0; i < job->material_count; i++) {
        look |= job->material[i].reflective > 0 ? ABI_LOOK_REFLECT : 0;
        look |= job->material[i].specular != 0 ? ABI_LOOK_SPECULAR : 0;
    }
    return look;
}

static enum status make_general(const struct frame_job *job, struct frame_dispatch *out,
                                struct reason *reason)
{
    if (job->light_count > FRAME_GENERAL_LIGHTS || job->look.bounces > FRAME_GENERAL_BOUNCES)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: the pipeline for every scene has room for %u lights and %u bounces, "
                    "not for %u and %u",
                    FRAME_GENERAL_LIGHTS, FRAME_GENERAL_BOUNCES, job->light_count,
                    job->look.bounces);
    out->constant[ABI_SPEC_STACK] =
        job->job.packed ? layout_stack_most(job->job.packed->layout) : ABI_STACK_MAX;
    out->constant[ABI_SPEC_BOUNCES] = FRAME_GENERAL_BOUNCES;
    out->constant[ABI_SPEC_LIGHTS] = FRAME_GENERAL_LIGHTS;
    out->constant[ABI_SPEC_LOOK] =
        ABI_LOOK_EYE | ABI_LOOK_AMBIENCE | ABI_LOOK_SPECULAR | ABI_LOOK_REFLECT | ABI_LOOK_GENERAL;
    return STATUS_OK;
}

static uint32_t tile_of(const struct frame_job *job, const struct vk_limits *limits)
{
    uint32_t tile = job->tile ? job->tile : FRAME_TILE_MOST;
    while (!job->tile && tile * tile > limits->group_size)
        tile /= 2;
    return tile;
}

/* Finds the module of the layout. The tree's constants and push constants are those of the
 * tracer. */
static enum status find_shader(const struct frame_job *job, bool brute, struct frame_dispatch *out,
                               struct reason *reason)
{
    struct dispatch trace = dispatch_brute(&job->job, 1);
    char name[64] = "render_brute";
    enum status status = STATUS_OK;
    if (!brute) {
        snprintf(name, sizeof name, "render_%s", layout_shader(job->job.packed->layout));
        status = dispatch_tree(&job->job, 1, &trace, reason);
        out->push.root = trace.push.root;
        out->push.node_count = trace.push.node_count;
        out->push.item_count = trace.push.item_count;
    }
    out->constant[ABI_SPEC_STACK] = trace.constant[ABI_SPEC_STACK];
    out->constant[ABI_SPEC_STORE] = trace.constant[ABI_SPEC_STORE];
    out->constant[ABI_SPEC_LAYOUT_0] = trace.constant[ABI_SPEC_LAYOUT_0];
    out->constant[ABI_SPEC_LAYOUT_1] = trace.constant[ABI_SPEC_LAYOUT_1];
    out->shader = shader_find(name);
    if (!status && !out->shader)
        status = fail(reason, STATUS_UNSUPPORTED, "vulkan: there is no shader %s", name);
    return status;
}

enum status frame_dispatch_make(const struct frame_job *job, bool brute,
                                const struct vk_limits *limits, struct frame_dispatch *out,
                                struct reason *reason)
{
    const uint32_t look = look_of(job), tri_count = job->job.scene->tri_count;
    const uint32_t tile = tile_of(job, limits);
    *out = (struct frame_dispatch){
        .constant = {[ABI_SPEC_WORKGROUP] = tile * tile,
                     [ABI_SPEC_BOX] = brute ? ABI_BOX_ROBUST : job->job.box->id,
                     [ABI_SPEC_TRI] = job->job.tri->id,
                     [ABI_SPEC_PROFILE] = job->look.profile,
                     [ABI_SPEC_BOUNCES] = job->look.bounces,
                     [ABI_SPEC_LIGHTS] = job->light_count,
                     [ABI_SPEC_TILE] = tile,
                     [ABI_SPEC_LOOK] = look},
        .push = {.tri_count = tri_count,
                 .part_last = tri_count,
                 .width = job->width,
                 .height = job->height,
                 .look = look,
                 .bounces = job->look.bounces,
                 .lights = job->light_count,
                 .ambience = job->look.ambience,
                 .tmin = job->tmin,
                 .tmax = job->tmax,
                 .offset = job->offset},
        .tile = tile,
        .rays = (uint32_t)rays_of_path(job),
        .part = brute ? DISPATCH_PART : UINT32_MAX,
        .cost = rays_of_path(job) * (brute ? tri_count + 1ull : job->job.packed->ref_count + 1ull),
    };
    frame_dispatch_plan(out, plan_of(job, brute));
    if (tile * tile > limits->group_size)
        return fail(reason, STATUS_UNSUPPORTED,
                    "vulkan: tiles of %u x %u: %s allows %u invocations", tile, tile,
                    limits->device, limits->group_size);
    enum status status = find_shader(job, brute, out, reason);
    if (!status && job->general)
        status = make_general(job, out, reason);
    return status;
}

void frame_dispatch_plan(struct frame_dispatch *dispatch, enum frame_plan plan)
{
    dispatch->plan = plan;
    dispatch->constant[ABI_SPEC_STEPS] = plan == FRAME_STEPS;
}

struct vk_shader frame_dispatch_shader(const struct frame_dispatch *dispatch)
{
    return (struct vk_shader){
        .name = dispatch->shader->name,
        .word = dispatch->shader->word,
        .word_count = dispatch->shader->word_count,
        .binding_count = FRAME_BINDINGS,
        .push_bytes = sizeof(struct frame_push),
        .constant = dispatch->constant,
        .constant_count = FRAME_CONSTANTS,
    };
}
