#include "gpu/shaders/pipelines.h"

#include <stdlib.h>
#include <string.h>

struct pipeline_kept {
    const uint32_t *word; /* identifies the module */
    uint32_t constant[VK_CONSTANTS_MAX];
    struct vk_pipeline *pipeline;
};

enum status pipelines_find(struct pipelines *pipelines, struct vk *vk,
                           const struct vk_shader *shader, struct vk_pipeline **out,
                           struct reason *reason)
{
    struct vk_shader compiled = *shader;
    enum status status = vk_compile(vk, &compiled, reason);
    if (status)
        return status;
    struct pipeline_kept want = {.word = compiled.word};
    memcpy(want.constant, shader->constant, shader->constant_count * sizeof want.constant[0]);
    for (size_t i = 0; i < pipelines->count; i++)
        if (pipelines->kept[i].word == want.word &&
            memcmp(pipelines->kept[i].constant, want.constant, sizeof want.constant) == 0) {
            *out = pipelines->kept[i].pipeline;
            return STATUS_OK;
        }
    if (array_reserve(&pipelines->kept, &pipelines->capacity, pipelines->count + 1, sizeof want))
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the list of pipelines");
    status = vk_pipeline_make(vk, &compiled, &want.pipeline, reason);
    if (status)
        return status;
    pipelines->kept[pipelines->count++] = want;
    *out = want.pipeline;
    return STATUS_OK;
}

void pipelines_free(struct pipelines *pipelines, struct vk *vk)
{
    for (size_t i = 0; i < pipelines->count; i++)
        vk_pipeline_free(vk, pipelines->kept[i].pipeline);
    free(pipelines->kept);
    *pipelines = (struct pipelines){0};
}
