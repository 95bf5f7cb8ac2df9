/* Compute pipelines and their dispatch. */
#include "gpu/vk/vk_private.h"
#include "gpu/vk/vk_settle.h"

#include <stdlib.h>

static enum status make_layout(struct vk *vk, struct vk_pipeline *pipeline, struct reason *reason)
{
    VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, pipeline->push_bytes};
    VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &pipeline->sets->layout,
        .pushConstantRangeCount = pipeline->push_bytes ? 1 : 0,
        .pPushConstantRanges = &push,
    };
    return vk_check(vk, vk->fn.CreatePipelineLayout(vk->device, &layout, NULL, &pipeline->layout),
                    "vkCreatePipelineLayout", reason);
}

static enum status make_pipeline(struct vk *vk, const struct vk_shader *shader,
                                 struct vk_pipeline *pipeline, struct reason *reason)
{
    uint32_t *settled = NULL;
    if (!vk->options.whole_modules && !shader->whole &&
        vk_settle(shader->word, shader->word_count, shader->constant, shader->constant_count,
                  &settled))
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %s", shader->name);
    VkShaderModuleCreateInfo code = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = 4 * (size_t)shader->word_count,
        .pCode = settled ? settled : shader->word,
    };
    VkShaderModule module;
    VkResult result = vk->fn.CreateShaderModule(vk->device, &code, NULL, &module);
    free(settled);
    if (result != VK_SUCCESS)
        return vk_check(vk, result, shader->name, reason);
    VkSpecializationMapEntry entry[VK_CONSTANTS_MAX];
    for (uint32_t i = 0; i < shader->constant_count; i++)
        entry[i] = (VkSpecializationMapEntry){i, 4 * i, 4};
    VkSpecializationInfo constants = {
        .mapEntryCount = shader->constant_count,
        .pMapEntries = entry,
        .dataSize = 4 * (size_t)shader->constant_count,
        .pData = shader->constant,
    };
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &constants},
        .layout = pipeline->layout,
    };
    result = vk->fn.CreateComputePipelines(vk->device, VK_NULL_HANDLE, 1, &info, NULL,
                                           &pipeline->pipeline);
    vk->fn.DestroyShaderModule(vk->device, module, NULL);
    return vk_check(vk, result, shader->name, reason);
}

enum status vk_compile(const struct vk *vk, struct vk_shader *shader, struct reason *reason)
{
    const struct vk_compiler *compiler = vk->options.compiler;
    return compiler ? compiler->compile(compiler->user, shader, reason) : STATUS_OK;
}

enum status vk_pipeline_make(struct vk *vk, const struct vk_shader *shader,
                             struct vk_pipeline **out, struct reason *reason)
{
    *out = NULL;
    if (shader->constant_count > 0 &&
        (shader->constant[0] == 0 || shader->constant[0] > vk->limits.group_size))
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: workgroups of %u: %s allows 1 to %u",
                    shader->constant[0], vk->limits.device, vk->limits.group_size);
    if (shader->binding_count > vk->limits.bindings)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: %s needs %u storage buffers, %s allows %u",
                    shader->name, shader->binding_count, vk->limits.device, vk->limits.bindings);
    struct vk_pipeline *pipeline = alloc_zeroed(1, sizeof *pipeline);
    if (!pipeline)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for a pipeline");
    pipeline->push_bytes = shader->push_bytes;
    pipeline->words = shader->words;
    enum status status = vk_sets_make(vk, shader->binding_count, shader->ways, shader->accel, 1,
                                      &pipeline->sets, reason);
    if (!status)
        status = make_layout(vk, pipeline, reason);
    if (!status)
        status = make_pipeline(vk, shader, pipeline, reason);
    if (status)
        vk_pipeline_free(vk, pipeline);
    else
        *out = pipeline;
    return status;
}

void vk_pipeline_free(struct vk *vk, struct vk_pipeline *pipeline)
{
    if (!pipeline || !vk_idle(vk))
        return;
    vk->fn.DestroyPipeline(vk->device, pipeline->pipeline, NULL);
    vk->fn.DestroyPipelineLayout(vk->device, pipeline->layout, NULL);
    vk_sets_free(vk, pipeline->sets);
    free(pipeline);
}

void vk_barrier(struct vk *vk, VkPipelineStageFlags from, VkAccessFlags written,
                VkPipelineStageFlags to, VkAccessFlags access)
{
    const VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = written,
        .dstAccessMask = access,
    };
    vk->fn.CmdPipelineBarrier(vk->command, from, to, 0, 1, &barrier, 0, NULL, 0, NULL);
}

void vk_barrier_for_reading(struct vk *vk)
{
    vk_barrier(vk, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
               VK_PIPELINE_STAGE_HOST_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
               VK_ACCESS_HOST_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
}

void vk_bind(struct vk *vk, const struct vk_pipeline *pipeline, VkDescriptorSet set,
             const void *push)
{
    vk->fn.CmdBindDescriptorSets(vk->command, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->layout, 0,
                                 1, &set, 0, NULL);
    if (pipeline->push_bytes)
        vk->fn.CmdPushConstants(vk->command, pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                pipeline->push_bytes, push);
}

#define TO_SHADERS (VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT)
#define SHADERS_READ                                                                               \
    (VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT)

static void record_step(struct vk *vk, VkDescriptorSet set, const struct vk_step *step)
{
    VkCommandBuffer command = vk->command;
    if (step->update) {
        vk->fn.CmdUpdateBuffer(command, step->update->buffer, 0, step->byte_count, step->bytes);
        vk_barrier(vk, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, TO_SHADERS,
                   SHADERS_READ);
    }
    vk->fn.CmdBindPipeline(command, VK_PIPELINE_BIND_POINT_COMPUTE, step->pipeline->pipeline);
    vk_bind(vk, step->pipeline, set, step->push);
    if (step->groups_of)
        vk->fn.CmdDispatchIndirect(command, step->groups_of->buffer, step->groups_at);
    else
        vk->fn.CmdDispatch(command, step->groups, 1, 1);
}

/* One set serves all steps: descriptor sets are compatible with all pipelines of the same
 * bindings. */
static void record(struct vk *vk, VkDescriptorSet set, const struct vk_step *step, uint32_t count)
{
    VkCommandBuffer command = vk->command;
    if (vk->query) {
        vk->fn.CmdResetQueryPool(command, vk->query, 0, 2);
        vk->fn.CmdWriteTimestamp(command, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, vk->query, 0);
    }
    for (uint32_t i = 0; i < count; i++) {
        if (i > 0)
            vk_barrier(vk, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                       TO_SHADERS | VK_PIPELINE_STAGE_TRANSFER_BIT,
                       SHADERS_READ | VK_ACCESS_TRANSFER_WRITE_BIT);
        record_step(vk, set, &step[i]);
    }
    if (vk->query)
        vk->fn.CmdWriteTimestamp(command, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, vk->query, 1);
    vk_barrier_for_reading(vk);
}

/* Replaces the host's time with the timestamps, if available. */
static void read_clock(struct vk *vk, struct vk_time *time)
{
    uint64_t tick[2];
    if (!vk->query ||
        vk->fn.GetQueryPoolResults(vk->device, vk->query, 0, 2, sizeof tick, tick, sizeof tick[0],
                                   VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
        return;
    uint64_t mask =
        vk->limits.timestamp_bits >= 64 ? UINT64_MAX : (1ull << vk->limits.timestamp_bits) - 1;
    double ns = (double)((tick[1] - tick[0]) & mask) * (double)vk->limits.timestamp_ns;
    time->ns = (uint64_t)ns;
    time->device_clock = true;
}

enum status vk_dispatch_series(struct vk *vk, struct vk_buffer *const *buffer,
                               const struct vk_step *step, uint32_t count, struct vk_time *time,
                               struct reason *reason)
{
    *time = (struct vk_time){0};
    for (uint32_t i = 0; i < count; i++)
        if (step[i].groups > vk->limits.groups)
            return fail(reason, STATUS_LIMIT, "vulkan: %u workgroups, %s allows %u", step[i].groups,
                        vk->limits.device, vk->limits.groups);
    enum status status = vk_begin(vk, reason);
    if (status)
        return status;
    const struct vk_sets *sets = step->pipeline->sets;
    VkDescriptorBufferInfo info[VK_BINDINGS_MAX];
    for (uint32_t i = 0; i < sets->bindings; i++)
        info[i] =
            (VkDescriptorBufferInfo){buffer[i]->buffer, 0, vk_buffer_size(vk, buffer[i]->bytes)};
    status = vk_bind_begin(vk, sets, reason);
    if (!status)
        status = vk_set_write(vk, sets, 0, step->pipeline->words, info, reason);
    if (status)
        return status;
    record(vk, sets->set[0], step, count);
    uint64_t start = time_ns();
    status = vk_submit(vk, count == 1 ? "a dispatch" : "a series of dispatches", reason);
    if (status)
        return status;
    time->ns = time_ns() - start;
    read_clock(vk, time);
    return STATUS_OK;
}

enum status vk_dispatch(struct vk *vk, struct vk_pipeline *pipeline,
                        struct vk_buffer *const *buffer, const void *push, uint32_t groups,
                        struct vk_time *time, struct reason *reason)
{
    const struct vk_step step = {.pipeline = pipeline, .push = push, .groups = groups};
    return vk_dispatch_series(vk, buffer, &step, 1, time, reason);
}
