/* Traversal without a stack: the same hits in the same order as with it, in C and on the device. */
#include "ref/packed/packed_walk.h"
#include "tests/support/all_hits_fixture.h"
#include "tests/support/tree_fixture.h"
#include "ref/twin/model.h"

#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS 400

static bool is_binary_tree(const struct fixture_stand *s, uint32_t **parent)
{
    struct reason reason;
    return packed_links(&s->packed, parent, &reason) == STATUS_OK;
}

/* Every layout, box test and query: bits of hits, and of the lists, which tell the order. */
static void finds_what_the_stack_finds(void **state)
{
    static const char *const scenes[] = {"soup:n=300", "sphere:n=9", "stack", "needles"};
    uint32_t compared = 0, more_boxes = 0;
    (void)state;
    for (size_t n = 0; n < ARRAY_COUNT(scenes); n++)
        for (size_t l = 0; layouts[l]; l++) {
            if (layout_is_wide(layouts[l]))
                continue;
            struct fixture_stand s = stand_make(scenes[n], "mixed", RAYS, layouts[l]->name, 4);
            uint32_t *parent = NULL;
            bool tree = is_binary_tree(&s, &parent);
            for (size_t b = 0; box_tests[b] && tree; b++)
                for (size_t i = 0; i < RAYS; i++) {
                    struct trace_counts with = {0, 0}, without = {0, 0};
                    struct hit a[64], c[64];
                    uint32_t found_a, found_c;
                    struct job stacked = {.scene = &s.scene,
                                          .packed = &s.packed,
                                          .box = box_tests[b],
                                          .tri = tri_tests[0]};
                    struct job linked = stacked;
                    linked.parent = parent;
                    for (enum query q = QUERY_CLOSEST; q <= QUERY_ANY; q++) {
                        stacked.query = linked.query = q;
                        assert_int_equal(trace_ray(&stacked, &s.ray[i], a, &with), STATUS_OK);
                        assert_int_equal(trace_ray(&linked, &s.ray[i], c, &without), STATUS_OK);
                        assert_memory_equal(a, c, sizeof *a);
                    }
                    assert_int_equal(with.tris, without.tris);
                    assert_true(with.boxes <= without.boxes);
                    more_boxes += with.boxes < without.boxes;
                    memset(a, 0, sizeof a);
                    memset(c, 0, sizeof c);
                    assert_int_equal(trace_ray_all(&stacked, &s.ray[i], 64, a, &found_a, NULL),
                                     STATUS_OK);
                    assert_int_equal(trace_ray_all(&linked, &s.ray[i], 64, c, &found_c, NULL),
                                     STATUS_OK);
                    assert_int_equal(found_a, found_c);
                    assert_memory_equal(a, c, sizeof a);
                    compared++;
                }
            free(parent);
            stand_free(&s);
        }
    assert_true(compared > 4 * 2 * 3 * RAYS - 1); /* f32 and rf16 at least */
    assert_true(more_boxes > compared / 10);
}

static void the_device_has_the_same_bits(void **state)
{
    const struct engine *cpu = engine_find("cpu_stackless"), *gpu = engine_find("vulkan_stackless");
    struct hit a[RAYS], b[RAYS];
    struct trace_report report;
    struct reason reason;
    (void)state;
    void *self_b = stand_open(gpu), *self_a = stand_open(cpu);
    for (size_t l = 0; layouts[l]; l++) {
        struct fixture_stand s = stand_make("soup:n=300", "mixed", RAYS, layouts[l]->name, 4);
        struct job job = stand_job(&s, "robust", "mt", QUERY_CLOSEST);
        enum status status = cpu->prepare(self_a, &job, &reason);
        assert_int_equal(gpu->prepare(self_b, &job, &reason), status);
        if (!status && engine_model(gpu, self_b, tri_tests[0]).bits) {
            assert_int_equal(cpu->trace(self_a, s.ray, RAYS, a, &report, &reason), STATUS_OK);
            assert_int_equal(gpu->trace(self_b, s.ray, RAYS, b, &report, &reason), STATUS_OK);
            assert_memory_equal(a, b, sizeof a);
        }
        stand_free(&s);
    }
    gpu->close(self_b);
    cpu->close(self_a);
}

/* A chain of nodes, each with a leaf that waits while the chain is followed to its end: triangle
 * `hit` is met by a ray through (1.5, 1.5), the others only have boxes there. */
static struct fixture_stand chain(const char *layout, uint32_t depth, enum trees_shape shape,
                                  uint32_t hit)
{
    struct fixture_stand s = {.scene = trees_grid(depth + 1)};
    struct reason reason = {""};
    for (uint32_t i = 0; i <= depth; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *p = &s.scene.vertex[9 * i + 3 * c], away = i == hit ? 2 : 0;
            uint32_t place = shape == TREES_RIGHT ? i : depth - i; /* the deepest is met first */
            p[0] = c == 1 ? 2 - away : away;
            p[1] = c == 2 ? 2 - away : away;
            p[2] = -(float)place;
        }
    s.bvh = trees_make(&s.scene, 1, shape);
    stand_must(packed_make(layout_find(layout), &s.bvh, &s.scene, &s.packed, &reason), &reason);
    assert_int_equal(s.packed.stack_need, depth);
    return s;
}

/* Whichever waits: it is come back to from the end of the chain. */
static void comes_back_to_every_level(void **state)
{
    static const char *const names[] = {"cpu", "cpu_stackless", "vulkan", "vulkan_stackless"};
    static const uint32_t depths[] = {1, 33, 64};
    const struct ray ray = {{1.5f, 1.5f, -1000}, 0, {0, 0, 1}, 1e6f};
    struct trace_report report;
    struct reason reason = {""};
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        void *self = stand_open(engine);
        for (size_t d = 0; d < ARRAY_COUNT(depths); d++)
            for (uint32_t hit = 0; hit <= depths[d]; hit++) {
                struct hit got;
                struct fixture_stand s = chain(hit % 2 ? "rf16" : "f32", depths[d],
                                               hit % 4 < 2 ? TREES_RIGHT : TREES_LEFT, hit);
                struct job job = stand_job(&s, "robust", "mt", QUERY_CLOSEST);
                stand_must(engine->prepare(self, &job, &reason), &reason);
                stand_must(engine->trace(self, &ray, 1, &got, &report, &reason), &reason);
                if (got.prim != hit)
                    fail_msg("%s, depth %u: triangle %d, not %u", names[e], depths[d],
                             (int)got.prim, hit);
                stand_free(&s);
            }
        engine->close(self);
    }
}

/* What is decoded of a cut tree is none. */
static void what_is_no_tree_is_refused(void **state)
{
    struct fixture_stand s = stand_make("soup:n=300", "mixed", 1, "f32", 4);
    struct reason reason;
    uint32_t *parent;
    (void)state;
    s.packed.word[3] = 1; /* the root's second child is its first */
    assert_int_equal(packed_links(&s.packed, &parent, &reason), STATUS_LIMIT);
    assert_null(parent);
    assert_non_null(strstr(reason.text, "f32: record 1 is reached more than once"));
    s.packed.word[3] = UINT32_MAX;
    assert_int_equal(packed_links(&s.packed, &parent, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "f32: record 0 lacks a child"));
    stand_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_what_the_stack_finds),
        cmocka_unit_test(the_device_has_the_same_bits),
        cmocka_unit_test(comes_back_to_every_level),
        cmocka_unit_test(what_is_no_tree_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
