/* All that gpu/vk can do, once, on the device of tests/gpu/fake_vulkan.h. Includes cmocka.h, whose
 * macros must come last. */
#ifndef TESTS_FAKE_WORK_H
#define TESTS_FAKE_WORK_H

#include "gpu/vk/vk.h"
#include "gpu/vk/vk_accel.h"

#include "tests/gpu/fake_vulkan.h"
#include "tests/support/gpu.h"

static inline struct vk_options fake_options(void)
{
    return (struct vk_options){.library = "", .device = -1};
}

/* What one run of all that vk.h has made. */
struct fake_work {
    struct vk *vk;
    struct vk_buffer *buffer[3];
    struct vk_pipeline *pipeline, *query;
    struct vk_sets *sets;
    struct vk_accel *accel;
};

static const uint32_t work_constant[] = {32, 7, 9};

static inline enum status work_make(struct fake_work *w, const struct vk_options *options,
                                    struct reason *reason)
{
    const struct shader *shader = shader_find("probe_abi");
    struct vk_shader of = {.name = "probe_abi",
                           .word = shader->word,
                           .word_count = shader->word_count,
                           .binding_count = 2,
                           .push_bytes = 8,
                           .constant = work_constant,
                           .constant_count = 3};
    enum status status = vk_open(options, &w->vk, reason);
    for (int i = 0; i < 3 && !status; i++)
        status =
            vk_buffer_make_of(w->vk, "0123456789abcdefghijklmnopqrstuv", 32, &w->buffer[i], reason);
    if (!status)
        status = vk_pipeline_make(w->vk, &of, &w->pipeline, reason);
    of.accel = true;
    if (!status && options->ray_query)
        status = vk_pipeline_make(w->vk, &of, &w->query, reason);
    if (!status)
        status = vk_sets_make(w->vk, 2, (struct vk_ways){0, 0}, false, 2, &w->sets, reason);
    if (!status && options->ray_query)
        status = vk_accel_make(w->vk, w->buffer[0], 3, w->buffer[1], 2, &w->accel, reason);
    if (!status && options->ray_query)
        vk_pipeline_use(w->vk, w->query, w->accel);
    return status;
}

static inline enum status work_use(struct fake_work *w, struct reason *reason)
{
    static const uint32_t push[2] = {11, 12};
    const struct vk_step step[] = {
        {.pipeline = w->pipeline, .push = push, .groups = 3},
        {.pipeline = w->pipeline,
         .push = push,
         .groups_of = w->buffer[2],
         .groups_at = 4,
         .update = w->buffer[2],
         .bytes = "ABCD",
         .byte_count = 4},
    };
    const struct vk_work work[] = {
        {.pipeline = w->pipeline, .part = {{0, 16}, {16, 16}}, .push = push, .groups = 5},
        {.pipeline = w->pipeline, .part = {{16, 8}, {0, 32}}, .push = push, .groups = 6},
    };
    struct vk_time time;
    char back[32];
    enum status status = vk_dispatch(w->vk, w->pipeline, w->buffer, push, 2, &time, reason);
    if (!status && time.device_clock)
        assert_int_equal(time.ns, 4000);
    if (!status)
        status = vk_dispatch_series(w->vk, w->buffer, step, 2, &time, reason);
    if (!status)
        status = vk_dispatch_many(w->vk, w->sets, w->buffer, work, 2, reason);
    if (!status)
        status = vk_buffer_read(w->vk, w->buffer[2], 0, back, 32, reason);
    if (!status)
        assert_memory_equal(back, "ABCD456789abcdefghijklmnopqrstuv", 32);
    if (!status)
        status = vk_buffer_grow(w->vk, 64, &w->buffer[1], reason);
    return status;
}

static inline void must_be_clean(const char *what)
{
    if (fake.wrong)
        fail_msg("%s: %s", what, fake.wrong);
    if (fake.alive)
        fail_msg("%s: %ld objects are left", what, fake.alive);
}

static inline struct vk *must_open(const struct vk_options *options)
{
    struct reason reason = {""};
    struct vk *vk;
    gpu_must(vk_open(options, &vk, &reason), &reason);
    return vk;
}

static inline void must_close(struct vk *vk)
{
    assert_int_equal(vk_close(vk, NULL), 0);
    must_be_clean("a device");
}

#endif
