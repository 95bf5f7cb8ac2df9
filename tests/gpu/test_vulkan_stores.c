/* Triangle storage on the GPU: the bits of engine cpu, alone and as one of many tasks. */
#include "ref/scene/quantise.h"
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/support/gpu.h"
#include "tests/support/tree_fixture.h"
#include "ref/store.h"

#define RAYS 256u

struct stores_stage {
    struct scene scene;
    struct bvh bvh;
    struct ray ray[RAYS];
    struct hit want[RAYS], got[RAYS];
    uint32_t flag[RAYS];
};

static void stage_make(const char *spec, uint32_t bits, struct stores_stage *s)
{
    struct reason reason = {""};
    struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    struct scene scene;
    struct quantised moved;
    gpu_must(scene_open(spec, 3, &scene, &reason), &reason);
    if (bits) /* on a grid, which one storage needs */
        gpu_must(scene_quantise_even(&scene, bits, &s->scene, &moved, &reason), &reason);
    else
        s->scene = scene;
    if (bits)
        scene_free(&scene);
    gpu_must(builder_find("median")->build(&s->scene, &options, &s->bvh, &reason), &reason);
    gpu_must(ray_set_make(ray_sets[0], &s->scene, 3, RAYS, s->ray, &reason), &reason);
}

static void stage_free(struct stores_stage *s)
{
    bvh_free(&s->bvh);
    scene_free(&s->scene);
}

static void assert_answers(struct stores_stage *s, struct tracer *tracer, const struct job *job)
{
    struct trace_report report;
    struct reason reason = {""};
    struct engine_task task = {
        .job = *job, .ray = s->ray, .ray_count = RAYS, .hit = s->got, .flag = s->flag};
    for (size_t i = 0; i < RAYS; i++)
        assert_int_equal(trace_ray(job, &s->ray[i], &s->want[i], NULL), STATUS_OK);
    gpu_must(tracer_prepare(tracer, job, &reason), &reason);
    gpu_must(tracer_trace(tracer, s->ray, RAYS, s->got, &report, &reason), &reason);
    assert_memory_equal(s->got, s->want, sizeof s->got);
    memset(s->got, 0xAA, sizeof s->got);
    gpu_must(tracer_trace_tasks(tracer, &task, 1, &reason), &reason);
    gpu_must(task.status, &task.reason);
    assert_memory_equal(s->got, s->want, sizeof s->got);
}

static void every_storage_has_the_bits_of_c(void **state)
{
    (void)state;
    /* The last one has triangles whose numbers take 18 bits. */
    static const char *const specs[] = {"soup:n=150", "sphere", "soup:n=150",
                                        "soup:n=140000,size=0.02"};
    static const uint32_t bits[] = {0, 16, 21, 9};
    const struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    static struct stores_stage s;
    for (size_t w = 0; w < ARRAY_COUNT(specs); w++) {
        stage_make(specs[w], bits[w], &s);
        for (size_t i = 0; tri_stores[i]; i++) {
            struct packed packed;
            struct reason reason = {""};
            size_t asked = 0;
            if (tri_stores[i]->head ? !bits[w] : w >= 2)
                continue;
            if (tri_stores[i]->id == ABI_STORE_DGF1 && bits[w] > 16)
                continue; /* its blocks are not as wide */
            gpu_must(
                packed_make_stored(layouts[0], tri_stores[i], &s.bvh, &s.scene, &packed, &reason),
                &reason);
            for (size_t t = 0; tri_tests[t]; t++) {
                struct job job = {.scene = &s.scene,
                                  .packed = &packed,
                                  .box = box_tests[0],
                                  .tri = tri_tests[t],
                                  .query = QUERY_CLOSEST};
                if (tri_store_answers(packed.store, tri_tests[t]->id)) {
                    assert_answers(&s, tracer, &job);
                    asked++;
                } else {
                    assert_int_equal(tracer_prepare(tracer, &job, &reason), STATUS_UNSUPPORTED);
                }
            }
            assert_true(asked > 0);
            packed_free(&packed);
        }
        stage_free(&s);
    }
    (void)tracer_close(tracer, NULL);
}

/* One leaf of `tris` triangles, whose last vertex is corner `corner` of triangle `last`: those
 * before it bring a vertex each, those behind it none. */
static void stage_of_leaf(struct stores_stage *s, uint32_t tris, uint32_t last, uint32_t corner)
{
    struct rng rng = rng_make(tris, corner);
    struct reason reason = {""};
    gpu_must(scene_make(3 + last, tris, &s->scene), &reason);
    for (uint32_t i = 0; i < 9 + 3 * last; i++)
        s->scene.vertex[i] = rng_range(&rng, -1, 1);
    for (uint32_t i = 0; i < tris; i++)
        for (uint32_t c = 0; c < 3; c++) {
            bool fresh = i > 0 && i <= last && c == corner;
            s->scene.index[3 * i + c] = fresh ? 2 + i : (i + c) % 3;
        }
    s->bvh = trees_make(&s->scene, tris, TREES_BALANCED);
    gpu_must(ray_set_make(ray_set_find("primary"), &s->scene, 3, RAYS, s->ray, &reason), &reason);
}

static void leaves_may_end_in_any_slot(void **state)
{
    (void)state;
    const struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    static struct stores_stage s;
    size_t hits = 0;
    for (uint32_t last = 0; last < 8; last++)
        for (uint32_t corner = 0; corner < 3; corner++) {
            struct packed packed;
            struct reason reason = {""};
            stage_of_leaf(&s, last % 2 ? 8 : last + 1, last, corner);
            gpu_must(packed_make_stored(layouts[0], tri_store_find("compact"), &s.bvh, &s.scene,
                                        &packed, &reason),
                     &reason);
            struct job job = {.scene = &s.scene,
                              .packed = &packed,
                              .box = box_test_find("robust"),
                              .tri = tri_test_find("mt"),
                              .query = QUERY_CLOSEST};
            assert_answers(&s, tracer, &job);
            for (size_t i = 0; i < RAYS; i++)
                hits += s.want[i].prim != ABI_NO_PRIM;
            packed_free(&packed);
            stage_free(&s);
        }
    assert_true(hits > 24 * RAYS / 10);
    (void)tracer_close(tracer, NULL);
}

/* Words that mean nothing: no fault of memory (RAYDIFF_VALIDATE=gpu would see one), an end, and the
 * same answers as C, which reads the same words. */
static void hostile_words_are_answered_as_in_c(void **state)
{
    (void)state;
    const struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct rng rng = rng_make(4, 1);
    static struct stores_stage s;
    stage_make("soup:n=150", QUANTISE_BITS_DEFAULT, &s); /* all that a block of dgf1 spans */
    for (size_t i = 0; tri_stores[i]; i++) {
        struct packed packed;
        struct reason reason = {""};
        gpu_must(packed_make_stored(layouts[0], tri_stores[i], &s.bvh, &s.scene, &packed, &reason),
                 &reason);
        for (uint32_t k = 0; k < packed.item_count; k += 1 + rng_below(&rng, 8))
            packed.item[k] ^= 1u << rng_below(&rng, 32);
        struct job job = {.scene = &s.scene,
                          .packed = &packed,
                          .box = box_tests[0],
                          .tri = tri_tests[0],
                          .query = QUERY_CLOSEST};
        for (size_t t = 0; !tri_store_answers(packed.store, job.tri->id); t++)
            job.tri = tri_tests[t];
        assert_answers(&s, tracer, &job);
        packed_free(&packed);
    }
    stage_free(&s);
    (void)tracer_close(tracer, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_storage_has_the_bits_of_c),
        cmocka_unit_test(leaves_may_end_in_any_slot),
        cmocka_unit_test(hostile_words_are_answered_as_in_c),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
