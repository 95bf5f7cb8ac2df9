/* An engine that was prepared for one job after another answers each as if it were the first: with
 * the bits of one that was opened for it alone. Scenes of all sizes, none at all among them. */
#include "ref/packed/packed_walk.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/support/drivers.h"

#define RAYS 300

static const char *const specs[] = {"sphere:n=4", "empty",    "soup:n=60,seed=3", "tall",
                                    "empty",      "soup:n=1", "sphere:n=4",       "empty"};

static struct scene scene_of(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (strcmp(spec, "empty") == 0)
        assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    else if (strcmp(spec, "tall") == 0) /* more triangles than before */
        gpu_must(scene_open("soup:n=900", 2, &scene, &reason), &reason);
    else
        gpu_must(scene_open(spec, 1, &scene, &reason), &reason);
    return scene;
}

/* All that a job borrows. */
struct again_stage {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    uint32_t *links;
    struct job job;
};

static void stage_make(struct again_stage *s, const char *spec, const struct engine *engine,
                       enum query query)
{
    const struct build_options build = {.leaf = 3, .eps = BUILD_EPS_DEFAULT};
    struct reason reason = {""};
    *s = (struct again_stage){.scene = scene_of(spec)};
    gpu_must(builder_find("median")->build(&s->scene, &build, &s->bvh, &reason), &reason);
    gpu_must(packed_make(layout_find("f32"), &s->bvh, &s->scene, &s->packed, &reason), &reason);
    gpu_must(packed_links(&s->packed, &s->links, &reason), &reason);
    s->job = (struct job){.scene = &s->scene,
                          .packed = engine->needs_packed ? &s->packed : NULL,
                          .box = box_tests[0],
                          .tri = tri_tests[0],
                          .query = query,
                          .parent = engine->needs_packed ? s->links : NULL};
}

static void stage_free(struct again_stage *s)
{
    free(s->links);
    packed_free(&s->packed);
    bvh_free(&s->bvh);
    scene_free(&s->scene);
}

/* Prepares and traces; the number of hits. */
static size_t play(const struct engine *engine, void *self, const struct job *job,
                   const struct ray *ray, struct hit hit[RAYS])
{
    struct trace_report report;
    struct reason reason = {""};
    size_t hits = 0;
    memset(hit, 0x5A, RAYS * sizeof *hit);
    gpu_must(engine->prepare(self, job, &reason), &reason);
    gpu_must(engine->trace(self, ray, RAYS, hit, &report, &reason), &reason);
    for (size_t i = 0; i < RAYS; i++)
        hits += hit[i].prim != ABI_NO_PRIM;
    return hits;
}

static void check_engine(const struct engine *engine, const struct ray *ray)
{
    const struct engine_options options = {.threads = 2, .device = -1};
    struct reason reason = {""};
    void *self, *fresh;
    if (engine_open(engine, &options, &self, &reason) == STATUS_UNSUPPORTED) {
        print_message("SKIP %s: %s\n", engine->name, reason.text);
        return;
    }
    const size_t turns = (engine->gpu ? 1 : 2) * ARRAY_COUNT(specs);
    for (size_t turn = 0; turn < turns; turn++) {
        struct hit hit[RAYS], wanted[RAYS];
        struct again_stage stage;
        const char *spec = specs[turn % ARRAY_COUNT(specs)];
        stage_make(&stage, spec, engine, turn / 3 % 2 ? QUERY_ANY : QUERY_CLOSEST);
        gpu_must(engine_open(engine, &options, &fresh, &reason), &reason);
        size_t hits = play(engine, fresh, &stage.job, ray, wanted);
        engine->close(fresh);
        (void)play(engine, self, &stage.job, ray, hit);
        assert_true((hits > 0) == (stage.scene.tri_count > 1));
        for (size_t i = 0; i < RAYS; i++)
            if (memcmp(&hit[i], &wanted[i], sizeof hit[i]) != 0)
                fail_msg("%s, %s as job %zu: ray %zu has triangle %u at %a, not %u at %a",
                         engine->name, spec, turn, i, hit[i].prim, (double)hit[i].t, wanted[i].prim,
                         (double)wanted[i].t);
        stage_free(&stage);
    }
    engine->close(self);
}

static void a_job_leaves_nothing_to_the_next(void **state)
{
    (void)state;
    static const char *const names[] = {
        "cpu",    "cpu_stackless", "brute",  "fast",         "fast_small",
        "embree", "embree_robust", "vulkan", "vulkan_brute", "vulkan_stackless",
        "kd",     "dual_split"};
    static struct ray ray[RAYS];
    struct scene scene = scene_of(specs[0]);
    assert_int_equal(ray_set_make(ray_set_find("random"), &scene, 4, RAYS, ray, NULL), STATUS_OK);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        assert_non_null(engine_find(names[i]));
        check_engine(engine_find(names[i]), ray);
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_job_leaves_nothing_to_the_next)};
    return cmocka_run_group_tests_name("prepared_again", tests, NULL, NULL);
}
