/* A job of tracing as a program in WGSL with its data. */
#ifndef WEBGPU_JOB_H
#define WEBGPU_JOB_H

#include "gpu/webgpu/webgpu_peer.h"
#include "ref/engine.h"

/* What walk.wgsl writes. */
struct webgpu_answer {
    struct hit hit;
    uint32_t flag;
};
_Static_assert(sizeof(struct webgpu_answer) == 20, "five words an answer");

/* Owns its text and corners (webgpu_job_free); the arrays of the tree are the job's. Records that
 * go in are struct ray, those that come out struct webgpu_answer. */
struct webgpu_job {
    struct webgpu_program program;
    char *text;
    float *corners; /* triangles in the order of the scene, nine floats each */
    uint64_t bytes; /* of the buffers */
};

/* The job has a packed tree. Errors: as webgpu_text; *out is zero then. */
enum status webgpu_job_make(const struct job *job, struct webgpu_job *out,
                            struct reason *reason) MUST_USE;

/* A zero job is fine. */
void webgpu_job_free(struct webgpu_job *job);

#endif
