/* What the tests of the Vulkan side share. Includes cmocka.h, whose macros must come
 * last. */
#ifndef TESTS_GPU_H
#define TESTS_GPU_H

#include "gpu/shaders/shaders.h"
#include "gpu/trace/tracer.h"
#include "ref/engine.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline struct vk_options gpu_options(void)
{
    const char *validate = getenv("RAYDIFF_VALIDATE");
    return (struct vk_options){.device = -1,
                               .validate = validate && strcmp(validate, "1") == 0,
                               .watch = validate && strcmp(validate, "gpu") == 0};
}

/* The drivers that need no GPU. */
static const char *const cpu_drivers[] = {"stock", "mesa25", "swiftshader"};

/* NULL where no device can be opened; the reason has been printed. */
static inline struct vk *gpu_open_or_null(const struct vk_options *options)
{
    struct vk *vk;
    struct reason reason = {""};
    enum status status = vk_open(options, &vk, &reason);
    if (status == STATUS_UNSUPPORTED) {
        assert_null(vk);
        print_message("SKIP %s\n", reason.text);
        return NULL;
    }
    if (status)
        fail_msg("%s", reason.text);
    return vk;
}

/* The same on one of cpu_drivers. */
static inline struct vk *gpu_open_driver(const char *driver)
{
    struct vk_options options = gpu_options();
    options.driver = driver;
    return gpu_open_or_null(&options);
}

/* Where no device can be opened the test is skipped with the reason. */
static inline struct vk *gpu_open(const struct vk_options *options)
{
    struct vk *vk = gpu_open_or_null(options);
    if (!vk)
        skip();
    return vk;
}

static inline struct tracer *gpu_tracer(const struct vk_options *options, uint32_t workgroup)
{
    struct tracer *tracer;
    struct reason reason = {""};
    enum status status = tracer_open(options, workgroup, &tracer, &reason);
    if (status == STATUS_UNSUPPORTED) {
        assert_null(tracer);
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    if (status)
        fail_msg("%s", reason.text);
    return tracer;
}

/* Closing must not complain: under validation that covers leaks. */
static inline void gpu_close_tracer(struct tracer *tracer)
{
    struct reason reason = {""};
    if (tracer_close(tracer, &reason))
        fail_msg("%s", reason.text);
}

static inline void gpu_close(struct vk *vk)
{
    struct reason reason = {""};
    if (vk_close(vk, &reason))
        fail_msg("%s", reason.text);
}

typedef void gpu_play_fn(struct vk *vk, const char *driver, void *of);

/* Plays on each of cpu_drivers that is here; false if none is. */
static inline bool gpu_on_cpu_drivers(gpu_play_fn *play, void *of)
{
    bool any = false;
    for (size_t d = 0; d < sizeof cpu_drivers / sizeof *cpu_drivers; d++) {
        struct vk *vk = gpu_open_driver(cpu_drivers[d]);
        if (!vk)
            continue;
        play(vk, cpu_drivers[d], of);
        gpu_close(vk);
        any = true;
    }
    return any;
}

static inline void gpu_must(enum status status, const struct reason *reason)
{
    if (status)
        fail_msg("%s", reason->text);
}

/* True if the tracer runs on Mesa's software driver, whose arithmetic is IEEE. */
static inline bool gpu_is_lavapipe(const struct vk *vk)
{
    return strstr(vk_limits(vk)->device, "llvmpipe") != NULL;
}

/* Runs the embedded shader `name` once: `groups` workgroups of `constant[0]`, its buffers of
 * `bytes[i]` from data[i]; reads all buffers back. */
static inline void gpu_run_on(struct vk *vk, const char *name, const uint32_t *constant,
                              uint32_t constant_count, const void *push, uint32_t push_bytes,
                              uint32_t groups, uint32_t buffer_count, const uint64_t *bytes,
                              void *const *data)
{
    struct reason reason = {""};
    const struct shader *shader = shader_find(name);
    struct vk_buffer *buffer[VK_BINDINGS_MAX];
    struct vk_pipeline *pipeline;
    struct vk_time time;
    assert_non_null(shader);
    struct vk_shader make = {.name = name,
                             .word = shader->word,
                             .word_count = shader->word_count,
                             .binding_count = buffer_count,
                             .push_bytes = push_bytes,
                             .constant = constant,
                             .constant_count = constant_count};
    gpu_must(vk_pipeline_make(vk, &make, &pipeline, &reason), &reason);
    for (uint32_t i = 0; i < buffer_count; i++) {
        gpu_must(vk_buffer_make(vk, bytes[i], &buffer[i], &reason), &reason);
        gpu_must(vk_buffer_write(vk, buffer[i], 0, data[i], bytes[i], &reason), &reason);
    }
    gpu_must(vk_dispatch(vk, pipeline, buffer, push, groups, &time, &reason), &reason);
    for (uint32_t i = 0; i < buffer_count; i++) {
        gpu_must(vk_buffer_read(vk, buffer[i], 0, data[i], bytes[i], &reason), &reason);
        vk_buffer_free(vk, buffer[i]);
    }
    vk_pipeline_free(vk, pipeline);
}

/* The same on buffers of zeros. */
static inline void gpu_run(struct vk *vk, const char *name, const uint32_t *constant,
                           uint32_t constant_count, const void *push, uint32_t push_bytes,
                           uint32_t groups, uint32_t buffer_count, const uint64_t *bytes,
                           void *const *data)
{
    for (uint32_t i = 0; i < buffer_count; i++)
        memset(data[i], 0, bytes[i]);
    gpu_run_on(vk, name, constant, constant_count, push, push_bytes, groups, buffer_count, bytes,
               data);
}

/* Opens `engine` on `driver`; NULL, with the reason printed, where it cannot run. */
static inline void *driver_open(const char *engine, const char *driver)
{
    const struct engine_options options = {.driver = driver, .device = -1};
    struct reason reason = {""};
    void *self = NULL;
    enum status status = engine_open(engine_find(engine), &options, &self, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        return NULL;
    }
    gpu_must(status, &reason);
    return self;
}

#endif
