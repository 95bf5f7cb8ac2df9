/* The engines and the renderer on the device of tests/gpu/fake_vulkan.h. Includes cmocka.h, whose
 * macros must come last. */
#ifndef TESTS_FAKE_ENGINES_H
#define TESTS_FAKE_ENGINES_H

#include "gpu/frame/framer.h"
#include "ref/world/world.h"
#include "tests/gpu/fake_work.h"

#include "tests/support/pictures.h"
#include "tests/support/trace_fixture.h"

/* Every ray is done. */
static inline void all_done(const struct fake_dispatch *dispatch)
{
    const struct fake_part *flags = &dispatch->part[ABI_BIND_FLAGS];
    for (uint64_t i = 0; i + 4 <= flags->bytes; i += 4)
        memcpy(flags->byte + flags->offset + i, &(uint32_t){ABI_FLAG_DONE}, 4);
}

#define RAYS 5u

/* A scene, its tree, and rays. */
struct fake_stage {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray ray[RAYS];
};

static inline struct fake_stage stage_make(void)
{
    struct fake_stage s = {.scene = generated("soup:n=20")};
    s.bvh = median(&s.scene, 2);
    s.packed = pack("f32", &s.bvh, &s.scene);
    for (uint32_t i = 0; i < RAYS; i++)
        s.ray[i] = (struct ray){{0, 0, 0}, 0, {1, (float)i, 0}, 1};
    return s;
}

static inline void stage_free(struct fake_stage *s)
{
    packed_free(&s->packed);
    bvh_free(&s->bvh);
    scene_free(&s->scene);
}

/* Everything that the engine does with rays, until something fails. */
static inline enum status engine_play(const struct engine *engine, const struct fake_stage *s,
                                      struct reason *reason)
{
    const struct engine_options options = {.device = -1};
    struct job job = {.scene = &s->scene,
                      .packed = engine->needs_packed ? &s->packed : NULL,
                      .box = box_test_find("robust"),
                      .tri = tri_test_find("mt"),
                      .query = QUERY_CLOSEST};
    struct hit hit[2 * RAYS];
    uint32_t count[RAYS], flag[2][RAYS];
    struct trace_report report;
    struct engine_task task[2];
    void *self = NULL;
    *reason = (struct reason){""};
    enum status status = engine_open(engine, &options, &self, reason);
    if (!status)
        status = engine->prepare(self, &job, reason);
    if (!status)
        status = engine->trace(self, s->ray, RAYS, hit, &report, reason);
    job.query = QUERY_ALL;
    if (!status && engine->trace_all)
        status = engine->prepare(self, &job, reason);
    if (!status && engine->trace_all)
        status = engine->trace_all(self, s->ray, RAYS, 2, hit, count, reason);
    job.query = QUERY_ANY;
    for (int i = 0; i < 2; i++)
        task[i] = (struct engine_task){
            .job = job, .ray = s->ray, .ray_count = RAYS, .hit = hit, .flag = flag[i]};
    if (!status && engine->trace_tasks)
        status = engine->trace_tasks(self, task, 2, reason);
    engine->close(self);
    return status;
}

/* The same with a world, which is the scene in one instance, of an engine that needs no trees. */
static inline enum status world_play(const struct engine *engine, const struct fake_stage *s,
                                     struct reason *reason)
{
    const struct engine_options options = {.device = -1};
    struct hit hit[2 * RAYS];
    uint32_t tag[2 * RAYS], count[RAYS];
    struct trace_report report;
    struct world world;
    void *self = NULL;
    *reason = (struct reason){""};
    enum status status = world_of_scene(&s->scene, &world, reason);
    if (status)
        return status;
    struct world_job job = {.world = &world,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt"),
                            .query = QUERY_CLOSEST};
    status = engine_open(engine, &options, &self, reason);
    if (!status)
        status = engine->worlds->prepare_world(self, &job, reason);
    if (!status)
        status = engine->worlds->trace_world(self, s->ray, NULL, RAYS, hit, tag, &report, reason);
    job.query = QUERY_ALL;
    if (!status)
        status = engine->worlds->prepare_world(self, &job, reason);
    if (!status)
        status =
            engine->worlds->trace_world_all(self, s->ray, NULL, RAYS, 2, hit, tag, count, reason);
    engine->close(self);
    world_free(&world);
    return status;
}

/* Those of engine_names that world_play takes. */
static const char *const world_names[] = {"vulkan_brute", "rayquery"};

static const char *const engine_names[] = {"vulkan", "vulkan_stackless", "vulkan_brute",
                                           "rayquery"};

/* Every path is done. */
static inline void all_drawn(const struct fake_dispatch *dispatch)
{
    const struct fake_part *pixels = &dispatch->part[ABI_BIND_PIXELS];
    struct frame_push push;
    memcpy(&push, dispatch->push, sizeof push);
    const uint32_t pixel = 0x030201u | (ABI_FLAG_DONE | push.serial << ABI_FLAG_BITS) << 24;
    for (uint64_t i = 0; i + 4 <= pixels->bytes; i += 4)
        memcpy(pixels->byte + pixels->offset + i, &pixel, 4);
}

#define FRAME_WIDTH  40u
#define FRAME_HEIGHT 50u

static inline struct picture frame_picture(bool rtrs)
{
    static const struct look mended = {PROFILE_REPAIRED, 3, 0.125f, 0.5f};
    static const struct look published = {PROFILE_RTRS, 3, 0.1f, 0};
    return picture_make("sphere:n=40", rtrs ? published : mended, FRAME_WIDTH, FRAME_HEIGHT);
}

/* Two frames of one job on a device that is opened for it. */
static inline enum status frame_play(struct picture *p, bool brute, enum frame_plan plan,
                                     struct reason *reason)
{
    const struct vk_options options = fake_options();
    struct vk *vk;
    *reason = (struct reason){""};
    enum status status = vk_open(&options, &vk, reason);
    if (status)
        return status;
    struct framer *framer = framer_make(vk, brute);
    picture_settle(p);
    p->job.plan = plan;
    if (!framer) { /* what has no reason to give */
        (void)snprintf(reason->text, sizeof reason->text, "no memory");
        status = STATUS_MEMORY;
    }
    if (!status)
        status = framer_prepare(framer, &p->job, reason);
    for (int i = 0; i < 2 && !status; i++)
        status = framer_draw(framer, &p->view, &p->frame, &p->report, reason);
    framer_free(framer);
    assert_int_equal(vk_close(vk, NULL), 0);
    return status;
}

/* Two jobs, one after the other, of an engine that draws. */
static inline enum status engine_frame_play(const struct engine *engine, struct picture *p,
                                            struct reason *reason)
{
    const struct engine_options options = {.device = -1};
    void *self = NULL;
    *reason = (struct reason){""};
    enum status status = engine_open(engine, &options, &self, reason);
    picture_settle(p);
    p->job.plan = FRAME_AUTO;
    for (int i = 0; i < 2 && !status; i++) {
        status = engine->renderer->prepare(self, &p->job, reason);
        if (!status)
            status = engine->renderer->draw(self, &p->view, &p->frame, &p->report, reason);
    }
    engine->close(self);
    return status;
}

/* Those of engine_names that it takes. */
static const char *const frame_names[] = {"vulkan", "vulkan_brute"};

#endif
