#include "gpu/card/probe_once.h"

enum status probe_once(struct vk *vk, const struct probe_job *job, struct reason *reason)
{
    struct vk_shader make = {.name = job->shader->name,
                             .word = job->shader->word,
                             .word_count = job->shader->word_count,
                             .binding_count = 2,
                             .push_bytes = job->push_bytes,
                             .constant = &job->group,
                             .constant_count = 1};
    struct vk_pipeline *pipeline = NULL;
    struct vk_buffer *buffer[2] = {NULL, NULL};
    struct vk_time time;
    enum status status = vk_pipeline_make(vk, &make, &pipeline, reason);
    if (!status)
        status = vk_buffer_make_of(vk, job->in, job->in_bytes, &buffer[0], reason);
    if (!status)
        status = vk_buffer_make(vk, job->out_bytes, &buffer[1], reason);
    if (!status)
        status = vk_dispatch(vk, pipeline, buffer, job->push, job->groups, &time, reason);
    if (!status)
        status = vk_buffer_read(vk, buffer[1], 0, job->out, job->out_bytes, reason);
    vk_buffers_free(vk, buffer, ARRAY_COUNT(buffer));
    vk_pipeline_free(vk, pipeline);
    return status;
}
