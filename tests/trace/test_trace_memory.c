/* Laws of the memory that an engine on the CPU reports: what its traversal reads, and nothing
 * else. */
#include "ref/store.h"
#include "tests/support/all_hits_fixture.h"

#define RAYS 8

/* Bytes of vertices and indices. */
static uint64_t scene_bytes(const struct scene *scene)
{
    return scene->vertex_count * (uint64_t)sizeof(float[3]) +
           scene->tri_count * (uint64_t)sizeof(uint32_t[3]);
}

/* Of a job just traced; 0 if the engine does not support it. */
static uint64_t told(const char *name, const struct fixture_stand *s, const struct packed *packed)
{
    const struct engine *engine = engine_find(name);
    struct engine_options options = {.threads = 2, .device = -1};
    struct job job = stand_job(s, "robust", "mt", QUERY_CLOSEST);
    struct trace_report report = {.memory_bytes = 0};
    struct reason reason = {""};
    struct hit hit[RAYS];
    void *self;
    job.packed = packed;
    stand_must(engine_open(engine, &options, &self, &reason), &reason);
    enum status status = engine->prepare(self, &job, &reason);
    if (!status)
        stand_must(engine->trace(self, s->ray, s->ray_count, hit, &report, &reason), &reason);
    engine->close(self);
    return status ? 0 : report.memory_bytes;
}

/* Each layout with each storage that it supports: nodes, items, and the scene where the storage
 * holds no vertices. The links of a traversal without a stack are a word for each reference. */
static void a_tree_is_nodes_and_items_and_what_they_refer_to(void **state)
{
    (void)state;
    uint32_t with_scene = 0, without = 0, linked = 0, wide = 0;
    struct fixture_stand s = stand_make("soup:n=300", "random", RAYS, "f32", 4);
    for (size_t l = 0; layouts_all[l]; l++)
        for (size_t t = 0; tri_stores[t]; t++) {
            struct packed packed;
            struct reason reason = {""};
            if (packed_make_stored(layouts_all[l], tri_stores[t], &s.bvh, &s.scene, &packed,
                                   &reason))
                continue;
            bool scene = !tri_stores[t]->tri && !tri_stores[t]->test;
            uint64_t want = (uint64_t)packed.node_count * layouts_all[l]->node_bytes +
                            packed.item_count * (uint64_t)sizeof *packed.item +
                            (scene ? scene_bytes(&s.scene) : 0);
            assert_int_equal(packed.word_count * (uint64_t)sizeof *packed.word,
                             packed.node_count * (uint64_t)layouts_all[l]->node_bytes);
            uint64_t got = told("cpu", &s, &packed), links = told("cpu_stackless", &s, &packed);
            if (got != 0 && got != want)
                fail_msg("%s %s: %llu bytes, not %llu", layouts_all[l]->name, tri_stores[t]->name,
                         (unsigned long long)got, (unsigned long long)want);
            if (links != 0)
                assert_int_equal(links, want + packed.ref_count * (uint64_t)sizeof(uint32_t));
            with_scene += got != 0 && scene;
            without += got != 0 && !scene && packed.item_count > 0;
            linked += links != 0;
            wide += got != 0 && layout_is_wide(layouts_all[l]);
            packed_free(&packed);
        }
    stand_free(&s);
    if (with_scene < 5 || without < 3 || linked < 8 || wide < 8)
        fail_msg("%u, %u, %u and %u trees are too few", with_scene, without, linked, wide);
}

/* More vertices than triangles, and fewer. */
static void without_a_tree_it_is_the_scene(void **state)
{
    (void)state;
    static const char *const scenes[] = {"soup:n=300", "sphere:n=9"};
    for (size_t i = 0; i < ARRAY_COUNT(scenes); i++) {
        struct fixture_stand s = stand_make(scenes[i], "random", RAYS, "f32", 4);
        assert_int_equal(told("brute", &s, NULL), scene_bytes(&s.scene));
        stand_free(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_is_nodes_and_items_and_what_they_refer_to),
        cmocka_unit_test(without_a_tree_it_is_the_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
