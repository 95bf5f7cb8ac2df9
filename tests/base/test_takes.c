/* What builders, generators and ray sets say that they read is what their results depend on:
 * commands refuse options by it. */
#include "ref/tree/bvh.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static bool is_taken(const struct builder *builder, const char *option)
{
    const char *at = builder->takes ? strstr(builder->takes, option) : NULL;
    return at && (at[strlen(option)] == ' ' || at[strlen(option)] == '\0');
}

static struct bvh build(const struct builder *builder, const struct scene *scene,
                        const struct build_options *options)
{
    struct bvh bvh;
    struct reason reason = {""};
    assert_int_equal(bvh_build(builder, scene, options, &bvh, &reason), STATUS_OK);
    return bvh;
}

static bool same_tree(const struct bvh *a, const struct bvh *b)
{
    return a->node_count == b->node_count && a->prim_count == b->prim_count &&
           memcmp(a->node, b->node, a->node_count * sizeof *a->node) == 0 &&
           memcmp(a->prim, b->prim, a->prim_count * sizeof *a->prim) == 0;
}

static void builders_read_what_they_take(void **state)
{
    const struct build_options plain = {.leaf = 4, .eps = 0.02f};
    struct build_options other[6] = {plain, plain, plain, plain, plain, plain};
    static const char *const name[6] = {"eps",          "bins",        "radius",
                                        "split-budget", "split-alpha", "presplit"};
    struct scene scene;
    struct reason reason;
    (void)state;
    other[0].eps = 4;
    other[1].bins = 2;
    other[2].radius = 1;
    other[3].split_budget = -1;
    other[4].split_alpha = 1;
    other[5].presplit = 0.5f;
    assert_int_equal(scene_open("soup:n=3000,size=0.5", 1, &scene, &reason), STATUS_OK);
    for (size_t i = 0; builders_all[i]; i++)
        for (size_t k = 0; k < ARRAY_COUNT(other); k++) {
            struct bvh a = build(builders_all[i], &scene, &plain);
            struct bvh b = build(builders_all[i], &scene, &other[k]);
            if (same_tree(&a, &b) == is_taken(builders_all[i], name[k]))
                fail_msg("builder %s and --%s", builders_all[i]->name, name[k]);
            bvh_free(&a);
            bvh_free(&b);
        }
    scene_free(&scene);
}

static void generators_are_seeded_as_they_say(void **state)
{
    (void)state;
    for (size_t i = 0; generators[i]; i++) {
        struct scene a, b;
        struct reason reason;
        assert_int_equal(scene_open(generators[i]->name, 1, &a, &reason), STATUS_OK);
        assert_int_equal(scene_open(generators[i]->name, 2, &b, &reason), STATUS_OK);
        bool same = a.vertex_count == b.vertex_count && a.tri_count == b.tri_count &&
                    memcmp(a.vertex, b.vertex, 3 * sizeof *a.vertex * a.vertex_count) == 0;
        if (same != generators[i]->seedless)
            fail_msg("generator %s", generators[i]->name);
        scene_free(&a);
        scene_free(&b);
    }
}

static void ray_sets_are_seeded_as_they_say(void **state)
{
    struct scene scene;
    struct reason reason;
    static struct ray a[256], b[256];
    (void)state;
    assert_int_equal(scene_open("sphere", 1, &scene, &reason), STATUS_OK);
    for (size_t i = 0; ray_sets[i]; i++) {
        assert_int_equal(ray_set_make(ray_sets[i], &scene, 1, 256, a, &reason), STATUS_OK);
        assert_int_equal(ray_set_make(ray_sets[i], &scene, 2, 256, b, &reason), STATUS_OK);
        if ((memcmp(a, b, sizeof a) == 0) != ray_sets[i]->seedless)
            fail_msg("ray set %s", ray_sets[i]->name);
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(builders_read_what_they_take),
        cmocka_unit_test(generators_are_seeded_as_they_say),
        cmocka_unit_test(ray_sets_are_seeded_as_they_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
