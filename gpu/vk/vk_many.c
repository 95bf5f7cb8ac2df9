/* Many dispatches in one submission, each with parts of the same buffers. */
#include "gpu/vk/vk_private.h"

static void record(struct vk *vk, VkDescriptorSet set, const struct vk_work *work, bool bind)
{
    const struct vk_pipeline *pipeline = work->pipeline;
    if (bind)
        vk->fn.CmdBindPipeline(vk->command, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->pipeline);
    vk_bind(vk, pipeline, set, work->push);
    vk->fn.CmdDispatch(vk->command, work->groups, 1, 1);
}

enum status vk_dispatch_many(struct vk *vk, struct vk_sets *sets, struct vk_buffer *const *buffer,
                             const struct vk_work *work, uint32_t count, struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        if (work[i].groups > vk->limits.groups)
            return fail(reason, STATUS_LIMIT, "vulkan: %u workgroups, %s allows %u", work[i].groups,
                        vk->limits.device, vk->limits.groups);
    enum status status = vk_begin(vk, reason);
    if (status)
        return status;
    status = vk_bind_begin(vk, sets, reason);
    for (uint32_t i = 0; i < count && !status; i++) {
        VkDescriptorBufferInfo info[VK_BINDINGS_MAX];
        for (uint32_t b = 0; b < sets->bindings; b++)
            info[b] = (VkDescriptorBufferInfo){buffer[b]->buffer, work[i].part[b].offset,
                                               work[i].part[b].bytes};
        status = vk_set_write(vk, sets, i, work[i].pipeline->words, info, reason);
        if (!status)
            record(vk, sets->set[i], &work[i], i == 0 || work[i].pipeline != work[i - 1].pipeline);
    }
    if (status)
        return status;
    vk_barrier_for_reading(vk);
    return vk_submit(vk, "many dispatches", reason);
}
