/* One dispatch of a shader that is a probe. Includes cmocka.h, whose macros must come last. */
#ifndef TESTS_PROBE_MUST_H
#define TESTS_PROBE_MUST_H

#include "gpu/card/probe_once.h"

#include "tests/support/gpu.h"

/* Runs the shader `name` with the job's workgroups and buffers; a failure ends the test. */
static inline void probe_must(struct vk *vk, const char *name, struct probe_job job)
{
    struct reason reason = {""};
    job.shader = shader_find(name);
    gpu_must(probe_once(vk, &job, &reason), &reason);
}

#endif
