/* Variants of rayquery on the drivers that have ray queries. A tree that is made in another way, or
 * of the same triangles in another form, answers as the plain one: the triangles that are tested
 * are the same, bit for bit. What a known fault of a driver changes is left to `check`, whose
 * judge names it (docs/variants.md). */
#include "gpu/accel/accel_variant.h"
#include "gpu/engines/rayquery_named.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/support/gpu.h"
#include "tests/support/world_laws.h"
#include "tests/support/world_more_laws.h"

#include <stdio.h>

#define RAYS 400

/* Mesa 25, else any device that can; NULL, with the reason printed, where it cannot run. */
static void *open_any(const char *name)
{
    void *self = driver_open(name, "mesa25");
    return self ? self : driver_open(name, NULL);
}

static void need_ray_queries(void)
{
    void *self = open_any("rayquery");
    if (!self)
        skip();
    engine_find("rayquery")->close(self);
}

static const struct engine *named(const char *name)
{
    const struct engine *engine;
    struct reason reason = {""};
    if (rayquery_named(name, &engine, &reason))
        fail_msg("%s: %s", name, reason.text);
    return engine;
}

/* Words that lavapipe of Mesa 25.0 gets wrong. */
static bool has_known_fault(const char *name)
{
    static const char *const words[] = {":first_vertex", "x4", ":nan"};
    for (size_t i = 0; i < ARRAY_COUNT(words); i++)
        if (strstr(name, words[i]))
            return true;
    return false;
}

/* Traces rays through a scene. Returns false if the engine refuses the scene. */
static bool answers_of(const char *name, const struct scene *scene, enum query query,
                       const struct ray *ray, struct hit *hit)
{
    const struct engine *engine = engine_find(name);
    const struct job job = {
        .scene = scene, .box = box_tests[0], .tri = tri_tests[0], .query = query};
    struct trace_report report = {0};
    struct reason reason = {""};
    void *self = open_any(name);
    if (!self)
        return false;
    enum status status = engine->prepare(self, &job, &reason);
    if (!status)
        status = engine->trace(self, ray, RAYS, hit, &report, &reason);
    engine->close(self);
    if (status == STATUS_LIMIT)
        return false;
    gpu_must(status, &reason);
    assert_true(report.memory_bytes > scene->tri_count);
    return true;
}

static size_t differing(const struct hit *a, const struct hit *b, enum query query)
{
    size_t count = 0;
    for (size_t i = 0; i < RAYS; i++)
        count += query == QUERY_ANY ? (a[i].prim == ABI_NO_PRIM) != (b[i].prim == ABI_NO_PRIM)
                                    : memcmp(&a[i], &b[i], sizeof a[i]) != 0;
    return count;
}

/* The words of a name have no order: whichever is told, it is one engine, named as it is written
 * when it is told first or again. */
static void words_in_any_order_name_one_engine(void **state)
{
    (void)state;
    const size_t begin = strlen("rayquery:");
    for (size_t i = 0; accel_names[i]; i++) {
        const struct engine *written = named(accel_names[i]);
        char turned[200], copy[200];
        size_t words = 1;
        assert_string_equal(written->name, accel_names[i]);
        snprintf(turned, sizeof turned, "%s", accel_names[i]);
        for (const char *at = turned + begin; (at = strchr(at, ':')); at++)
            words++;
        for (size_t turn = 0; turn < words; turn++) { /* the first word becomes the last */
            char *first = turned + begin, *end = first + strcspn(first, ":");
            snprintf(copy, sizeof copy, "rayquery:%s%s%.*s", *end ? end + 1 : "", *end ? ":" : "",
                     (int)(end - first), first);
            memcpy(turned, copy, sizeof turned);
            assert_ptr_equal(named(turned), written);
        }
        assert_string_equal(turned, accel_names[i]);
    }
}

/* A scene without exact ties, as a soup has none, and the flat ones that small formats hold. */
static void every_variant_answers_as_the_plain_tree(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    static struct hit plain[RAYS], hit[RAYS];
    static const char *const scenes[] = {"soup:n=200", "tests/accel/square.obj"};
    size_t taken = 0;
    need_ray_queries();
    for (size_t s = 0; s < ARRAY_COUNT(scenes); s++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct scene scene;
            struct reason reason = {""};
            gpu_must(scene_open(scenes[s], 1, &scene, &reason), &reason);
            gpu_must(ray_set_make(ray_sets[0], &scene, 3, RAYS, ray, NULL), &reason);
            assert_true(answers_of("rayquery", &scene, (enum query)query, ray, plain));
            for (size_t i = 0; accel_names[i]; i++) {
                const struct engine *engine = named(accel_names[i]);
                if ((query == QUERY_ANY && i % 5) || has_known_fault(accel_names[i]) ||
                    (s == 1 && !strstr(accel_names[i], "x2")) ||
                    !answers_of(engine->name, &scene, (enum query)query, ray, hit))
                    continue;
                taken++;
                const size_t count = differing(plain, hit, (enum query)query);
                if (count)
                    fail_msg("%s on %s: %zu of %d answers differ", engine->name, scenes[s], count,
                             RAYS);
            }
            scene_free(&scene);
        }
    assert_true(taken > 30);
}

/* A variant with an update follows vertices that move, there and back, and has the bits of the
 * plain tree of where they are; others have no update. */
static void updates_follow_what_moves(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    static struct hit plain[2][RAYS], hit[RAYS];
    struct scene scene[2];
    struct reason reason = {""};
    size_t taken = 0;
    need_ray_queries();
    for (int i = 0; i < 2; i++)
        gpu_must(scene_open("soup:n=200", 1, &scene[i], &reason), &reason);
    for (size_t k = 0; k < 3 * (size_t)scene[1].vertex_count; k++)
        scene[1].vertex[k] = 2.0f - scene[1].vertex[k];
    gpu_must(ray_set_make(ray_sets[0], &scene[0], 3, RAYS, ray, NULL), &reason);
    for (int i = 0; i < 2; i++)
        assert_true(answers_of("rayquery", &scene[i], QUERY_CLOSEST, ray, plain[i]));
    assert_true(differing(plain[0], plain[1], QUERY_CLOSEST) > 50);
    for (size_t n = 0; accel_names[n]; n++) {
        const struct engine *engine = named(accel_names[n]);
        const bool updates = strstr(accel_names[n], ":update") != NULL;
        assert_true((engine->move != NULL) == updates);
        void *self = updates && !has_known_fault(accel_names[n]) ? open_any(engine->name) : NULL;
        for (int step = 0; self && step < 4; step++) {
            const struct job job = {.scene = &scene[step % 2],
                                    .box = box_tests[0],
                                    .tri = tri_tests[0],
                                    .query = QUERY_CLOSEST};
            struct trace_report report = {0};
            gpu_must((step ? engine->move : engine->prepare)(self, &job, &reason), &reason);
            gpu_must(engine->trace(self, ray, RAYS, hit, &report, &reason), &reason);
            assert_int_equal(differing(plain[step % 2], hit, QUERY_CLOSEST), 0);
        }
        taken += self != NULL;
        if (self)
            engine->close(self);
    }
    assert_true(taken > 5);
    scene_free(&scene[0]);
    scene_free(&scene[1]);
}

/* By the specification a copy is the structure that it is copied from, also where a driver gets
 * that wrong. */
static void copies_have_the_bits_of_what_they_copy(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    static struct hit plain[RAYS], hit[RAYS];
    static const char *const forms[] = {"", ":split5:nan", ":update:first_vertex:split2",
                                        ":update_into:degenerate", ":turned:unindexed:offset"};
    static const char *const copies[] = {":compact", ":clone", ":serialise", ":serialise_new"};
    struct scene scene;
    struct reason reason = {""};
    need_ray_queries();
    gpu_must(scene_open("stack:n=60,copies=3", 1, &scene, &reason), &reason);
    gpu_must(ray_set_make(ray_sets[0], &scene, 4, RAYS, ray, NULL), &reason);
    for (size_t f = 0; f < ARRAY_COUNT(forms); f++)
        for (size_t c = 0; c < ARRAY_COUNT(copies); c++) {
            char name[ACCEL_NAME_MOST];
            snprintf(name, sizeof name, "rayquery%s%s", forms[f], copies[c]);
            const struct engine *copy = named(name);
            assert_true(copy->plain_bits && copy->plain != copy);
            assert_int_equal(rayquery_variant_of(copy->plain) != NULL, f > 0 || c == 0);
            assert_true(answers_of(copy->name, &scene, QUERY_CLOSEST, ray, hit));
            assert_true(answers_of(copy->plain->name, &scene, QUERY_CLOSEST, ray, plain));
            assert_int_equal(differing(plain, hit, QUERY_CLOSEST), 0);
        }
    scene_free(&scene);
}

/* The same triangles are listed, in any order, and nothing that was added. */
static void lists_have_every_hit(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    static struct hit hit[2][RAYS * 64];
    static uint32_t found[2][RAYS];
    static const char *const names[] = {"rayquery:split7",
                                        "rayquery:update:split3:scaled:u16:offset",
                                        "rayquery:serialise:unindexed", "rayquery:degenerate"};
    struct scene scene;
    struct reason reason = {""};
    need_ray_queries();
    gpu_must(scene_open("soup:n=200", 1, &scene, &reason), &reason);
    gpu_must(ray_set_make(ray_sets[0], &scene, 3, RAYS, ray, NULL), &reason);
    const struct job job = {
        .scene = &scene, .box = box_tests[0], .tri = tri_tests[0], .query = QUERY_ALL};
    for (size_t n = 0; n < ARRAY_COUNT(names); n++) {
        size_t sum = 0;
        for (size_t k = 0; k < 2; k++) {
            const struct engine *engine = k ? named(names[n]) : engine_find("rayquery");
            void *self = open_any(engine->name);
            gpu_must(engine->prepare(self, &job, &reason), &reason);
            gpu_must(engine->trace_all(self, ray, RAYS, 64, hit[k], found[k], &reason), &reason);
            engine->close(self);
        }
        for (size_t i = 0; i < RAYS; i++) {
            assert_int_equal(found[0][i], found[1][i]);
            sum += found[0][i];
            for (size_t a = 0; a < found[0][i]; a++) {
                size_t b = 0;
                while (b < found[1][i] &&
                       memcmp(&hit[0][i * 64 + a], &hit[1][i * 64 + b], sizeof hit[0][0]) != 0)
                    b++;
                assert_true(b < found[1][i]);
            }
        }
        assert_true(sum > RAYS / 4);
    }
    scene_free(&scene);
}

/* Worlds keep their names, masks, flags and filters in every way of making them. Lavapipe of Mesa
 * 25.0 serialises what has no triangle to 0 bytes, and these worlds have such meshes. */
static void worlds_keep_their_laws(void **state)
{
    (void)state;
    static const char *const names[] = {"rayquery:fast_build:update:compact:u16:stride20",
                                        "rayquery:update_into:clone:scaled:offset",
                                        "rayquery:update:turned:unindexed:degenerate"};
    need_ray_queries();
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        struct laws laws = {.engine = named(names[i])};
        laws.self = open_any(laws.engine->name);
        assert_non_null(laws.self);
        laws_of_names(&laws);
        laws_of_masks(&laws);
        laws_of_flags(&laws);
        laws_of_filters(&laws);
        laws_of_lists(&laws);
        laws_of_nothing(&laws);
        laws.engine->close(laws.self);
    }
    assert_null(named("rayquery:split2")->worlds);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_in_any_order_name_one_engine),
        cmocka_unit_test(every_variant_answers_as_the_plain_tree),
        cmocka_unit_test(updates_follow_what_moves),
        cmocka_unit_test(copies_have_the_bits_of_what_they_copy),
        cmocka_unit_test(lists_have_every_hit),
        cmocka_unit_test(worlds_keep_their_laws),
    };
    return cmocka_run_group_tests_name("rayquery_variants", tests, NULL, NULL);
}
