/* Pictures drawn by shaders, and what they are compared with. Includes cmocka.h, whose macros must
 * come last. */
#ifndef TESTS_DRAWN_H
#define TESTS_DRAWN_H

#include "gpu/frame/framer.h"

#include "tests/support/gpu.h"
#include "tests/support/pictures.h"

#include <math.h>

static const struct look repaired = {PROFILE_REPAIRED, 4, 0.125f, 0.5f};
static const struct look rtrs = {PROFILE_RTRS, 4, 0.1f, 0};

/* A device and what draws on it. */
struct drawn_stand {
    struct vk *vk;
    struct framer *framer;
};

/* False, with the reason printed, where `driver` is not. */
static inline bool stand_open(const char *driver, bool brute, struct drawn_stand *out)
{
    struct vk_options options = gpu_options();
    struct reason reason = {""};
    options.driver = driver;
    enum status status = vk_open(&options, &out->vk, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        return false;
    }
    gpu_must(status, &reason);
    out->framer = framer_make(out->vk, brute);
    assert_non_null(out->framer);
    return true;
}

static inline struct drawn_stand stand_or_skip(bool brute)
{
    struct drawn_stand stand;
    if (!stand_open(NULL, brute, &stand))
        skip();
    return stand;
}

static inline void stand_close(struct drawn_stand *stand)
{
    framer_free(stand->framer);
    gpu_close(stand->vk);
}

/* Frames of the same size as the picture's. */
static inline struct frame drawn_make(const struct picture *p)
{
    const size_t pixels = (size_t)p->job.width * p->job.height;
    struct frame frame = {
        .pixel = calloc(pixels, sizeof *frame.pixel),
        .color = calloc(pixels, 3 * sizeof *frame.color),
        .segment = calloc(pixels, (p->job.look.bounces + 1) * sizeof *frame.segment),
    };
    assert_true(frame.pixel && frame.color && frame.segment);
    return frame;
}

static inline void draw(const struct drawn_stand *stand, struct picture *p, struct frame *out)
{
    struct reason reason = {""};
    picture_settle(p);
    gpu_must(framer_prepare(stand->framer, &p->job, &reason), &reason);
    gpu_must(framer_draw(stand->framer, &p->view, out, &p->report, &reason), &reason);
    assert_true(p->report.memory_bytes > 0);
}

/* --- what is compared ------------------------------------------------------------------------- */

/* Segments to the bit. */
static inline void same_paths(const char *what, const struct picture *p, const struct frame *a,
                              const struct frame *b)
{
    const size_t bounces = p->job.look.bounces;
    for (size_t i = 0; i < (size_t)p->job.width * p->job.height * bounces; i++)
        if (memcmp(&a->segment[i], &b->segment[i], sizeof *a->segment) != 0)
            fail_msg("%s: pixel %zu,%zu segment %zu: t %a prim %x asked %x shadowed %x and t %a "
                     "prim %x asked %x shadowed %x",
                     what, i / bounces % p->job.width, i / bounces / p->job.width, i % bounces,
                     (double)a->segment[i].t, a->segment[i].prim, a->segment[i].asked,
                     a->segment[i].shadowed, (double)b->segment[i].t, b->segment[i].prim,
                     b->segment[i].asked, b->segment[i].shadowed);
}

static inline void same_bits(const char *what, const struct picture *p, const struct frame *a,
                             const struct frame *b)
{
    const size_t pixels = (size_t)p->job.width * p->job.height;
    same_paths(what, p, a, b);
    for (size_t i = 0; i < pixels; i++)
        if (memcmp(a->color + 3 * i, b->color + 3 * i, 3 * sizeof(float)) != 0 ||
            a->pixel[i] != b->pixel[i])
            fail_msg("%s: pixel %zu,%zu is %x (%a %a %a) and %x (%a %a %a)", what, i % p->job.width,
                     i / p->job.width, a->pixel[i], (double)a->color[3 * i],
                     (double)a->color[3 * i + 1], (double)a->color[3 * i + 2], b->pixel[i],
                     (double)b->color[3 * i], (double)b->color[3 * i + 1],
                     (double)b->color[3 * i + 2]);
}

/* Paths to the bit, colours within the bound of C's, pixels as their own colours say. */
static inline void as_in_c(const char *what, const struct picture *p, const struct frame *c,
                           const struct frame *got)
{
    same_paths(what, p, c, got);
    for (size_t i = 0; i < 3 * (size_t)p->job.width * p->job.height; i++) {
        const double off = 255 * fabs((double)c->color[i] - (double)got->color[i]);
        const uint32_t level = got->pixel[i / 3] >> (8 * (i % 3)) & 255u;
        float kept = got->color[i] > 0 ? got->color[i] : 0;
        kept = kept < 1 ? kept : 1;
        if (!(off <= (double)c->bound[i / 3]))
            fail_msg("%s: pixel %zu: %a and %a, bound %g of 255", what, i / 3, (double)c->color[i],
                     (double)got->color[i], (double)c->bound[i / 3]);
        if (level != (uint32_t)(255.0f * kept + 0.5f) || got->pixel[i / 3] >> 24 != 255)
            fail_msg("%s: pixel %zu is %x of %a", what, i / 3, got->pixel[i / 3],
                     (double)got->color[i]);
    }
}

/* A scene whose materials are told: mirrors of several strengths, lights all around. */
static inline struct scene mirrors(const char *spec, uint32_t light_count, float specular)
{
    struct scene scene;
    struct reason reason = {""};
    gpu_must(scene_open(spec, 3, &scene, &reason), &reason);
    free(scene.material);
    free(scene.material_of);
    free(scene.light);
    scene.material_count = 3;
    scene.light_count = light_count;
    scene.material = calloc(3, sizeof *scene.material);
    scene.material_of = calloc(scene.tri_count, sizeof *scene.material_of);
    scene.light = calloc(light_count + 1, sizeof *scene.light);
    assert_true(scene.material && scene.material_of && scene.light);
    for (uint32_t i = 0; i < scene.tri_count; i++)
        scene.material_of[i] = (int32_t)(i % 3);
    for (uint32_t i = 0; i < 3; i++)
        scene.material[i] = (struct material){{0.25f * (float)(i + 1), 0.5f, 0.75f},
                                              {0.75f, specular, 0.375f * (float)i},
                                              3.5f * (float)i + 1};
    for (uint32_t i = 0; i < light_count; i++)
        scene.light[i] =
            (struct light){{3 * cosf((float)i), 4, 3 * sinf((float)i)}, 1.0f / (float)(i + 1)};
    return scene;
}

#endif
