#include "gpu/webgpu/webgpu_job.h"

#include "gpu/webgpu/webgpu_text.h"
#include "ref/store.h"

#include <stdlib.h>

/* NULL without memory. */
static float *gather(const struct scene *scene)
{
    float *out = alloc_zeroed((size_t)scene->tri_count + 1, ABI_TRI_FLOATS * sizeof *out);
    for (uint32_t i = 0; out && i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        for (uint32_t k = 0; k < ABI_TRI_FLOATS; k++)
            out[ABI_TRI_FLOATS * (size_t)i + k] = v[k / 3][k % 3];
    }
    return out;
}

enum status webgpu_job_make(const struct job *job, struct webgpu_job *out, struct reason *reason)
{
    const struct packed *packed = job->packed;
    *out = (struct webgpu_job){.text = NULL};
    enum status status = webgpu_text(job, &out->text, reason);
    if (status)
        return status;
    out->corners = gather(job->scene);
    if (!out->corners) {
        webgpu_job_free(out);
        return fail(reason, STATUS_MEMORY, "webgpu: no memory to gather triangles");
    }
    const size_t floats = ABI_TRI_FLOATS * (size_t)job->scene->tri_count;
    out->program = (struct webgpu_program){
        .text = out->text,
        .array = {{packed->word, packed->word_count},
                  {packed->item, packed->item_count},
                  {(const void *)out->corners, floats}},
        .into_words = sizeof(struct ray) / 4,
        .out_words = sizeof(struct webgpu_answer) / 4,
        .uniform = {0, packed->root, packed->ref_count, packed->item_count, job->scene->tri_count}};
    out->bytes = packed_node_bytes(packed) + packed_item_bytes(packed) + 4 * floats;
    return STATUS_OK;
}

void webgpu_job_free(struct webgpu_job *job)
{
    free(job->text);
    free(job->corners);
    *job = (struct webgpu_job){.text = NULL};
}
