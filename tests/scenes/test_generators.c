/* Laws that hold for every scene generator. */
#include "tests/scenes/generators.h"

#include <math.h>
#include <stdlib.h>

static uint64_t fnv(uint64_t hash, const void *data, size_t bytes)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < bytes; i++)
        hash = (hash ^ p[i]) * 0x100000001B3u;
    return hash;
}

/* FNV-1a of the vertex and then the index bytes. */
static uint64_t scene_hash(const struct scene *scene)
{
    uint64_t hash = 0xCBF29CE484222325u;
    hash = fnv(hash, scene->vertex, 3 * sizeof(float) * scene->vertex_count);
    return fnv(hash, scene->index, 3 * sizeof(uint32_t) * scene->tri_count);
}

static void table_names_are_unique_and_found(void **state)
{
    (void)state;
    for (size_t i = 0; generators[i]; i++) {
        assert_ptr_equal(generator_find(generators[i]->name), generators[i]);
        assert_true(strlen(generators[i]->summary) > 10);
    }
    assert_null(generator_find("nosuch"));
    assert_null(generator_find(""));
}

static void defaults_are_small_and_complete(void **state)
{
    (void)state;
    for (size_t g = 0; generators[g]; g++) {
        struct scene scene = make(generators[g]->name, NULL, 1);
        assert_in_range(scene.tri_count, 30, 4096);
        bool *used = calloc(scene.vertex_count, 1);
        assert_non_null(used);
        for (uint32_t i = 0; i < scene.tri_count; i++) {
            const uint32_t *v = scene.index + 3 * (size_t)i;
            assert_true(v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);
            used[v[0]] = used[v[1]] = used[v[2]] = true;
        }
        for (uint32_t i = 0; i < scene.vertex_count; i++)
            if (!used[i])
                fail_msg("%s: vertex %u is never used", generators[g]->name, i);
        free(used);
        scene_free(&scene);
    }
}

static void defaults_have_the_same_bytes_everywhere(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint64_t hash;
    } golden[] = {
        {"soup", 0x136A200C2795A67Eu},     {"sphere", 0xE3319EFA72564E29u},
        {"flake", 0x8967C3551FCBB2CFu},    {"terrain", 0x0EC7878F8D7F3EF5u},
        {"grid", 0x1DE03B40F2AA5C9Cu},     {"cornell", 0x8EFBEC11978E430Du},
        {"platonic", 0x73B6ABBDC30E0B71u}, {"needles", 0x4E53206694DEA8E0u},
        {"stack", 0xDA2B119A06D1F9CBu},    {"rtrs", 0xD82C950598A9348Eu},
    };
    size_t count = 0;
    bool same = true;
    for (; generators[count]; count++)
        ;
    assert_int_equal(count, ARRAY_COUNT(golden));
    for (size_t i = 0; i < count; i++) {
        struct scene scene = make(golden[i].name, NULL, 1);
        uint64_t hash = scene_hash(&scene);
        if (hash != golden[i].hash)
            print_error("%s: 0x%016llX\n", golden[i].name, (unsigned long long)hash);
        same = same && hash == golden[i].hash;
        scene_free(&scene);
    }
    assert_true(same);
}

static void the_seed_changes_what_is_random_only(void **state)
{
    (void)state;
    static const char *const random[] = {"soup", "terrain", "grid", "needles", "stack"};
    for (size_t g = 0; generators[g]; g++) {
        bool is_random = false;
        for (size_t i = 0; i < ARRAY_COUNT(random); i++)
            is_random = is_random || strcmp(random[i], generators[g]->name) == 0;
        struct scene a = make(generators[g]->name, NULL, 1);
        struct scene again = make(generators[g]->name, NULL, 1);
        struct scene b = make(generators[g]->name, NULL, 2);
        assert_true(scene_hash(&a) == scene_hash(&again));
        assert_true((scene_hash(&a) != scene_hash(&b)) == is_random);
        scene_free(&a);
        scene_free(&again);
        scene_free(&b);
    }
}

/* Each parameter alone at both ends of its range works, or refuses with its reason; outside the
 * range it always refuses. */
static void parameter_borders_hold(void **state)
{
    (void)state;
    for (size_t g = 0; generators[g]; g++)
        for (int k = 0; k < GENERATOR_PARAMS && generators[g]->param[k].name; k++) {
            const struct param *param = &generators[g]->param[k];
            double outside[] = {param->least - 1, param->most + 1, (double)NAN, INFINITY,
                                -INFINITY};
            assert_true(param->least <= param->value && param->value <= param->most);
            for (int end = 0; end < 2; end++) {
                struct scene scene;
                struct reason reason = {""};
                double value = end ? param->most : param->least;
                enum status status = try_make(generators[g]->name, SETTINGS({param->name, value}),
                                              3, &scene, &reason);
                if (status)
                    assert_true(status == STATUS_LIMIT && strlen(reason.text) > 0);
                else
                    assert_int_equal(scene_check(&scene, NULL), STATUS_OK);
                scene_free(&scene);
            }
            for (size_t i = 0; i < ARRAY_COUNT(outside); i++) {
                struct scene scene;
                struct reason reason = {""};
                assert_int_equal(try_make(generators[g]->name, SETTINGS({param->name, outside[i]}),
                                          3, &scene, &reason),
                                 STATUS_LIMIT);
                assert_non_null(strstr(reason.text, param->name));
                assert_null(scene.vertex);
                assert_int_equal(scene.tri_count, 0);
            }
        }
}

static void counts_must_be_whole(void **state)
{
    (void)state;
    static const char *const whole[][2] = {
        {"soup", "n"},      {"sphere", "n"},  {"flake", "depth"},    {"flake", "n"},
        {"terrain", "k"},   {"grid", "n"},    {"grid", "height"},    {"grid", "z"},
        {"grid", "offset"}, {"cornell", "n"}, {"platonic", "which"}, {"platonic", "rows"},
        {"needles", "n"},   {"stack", "n"},   {"stack", "copies"},   {"stack", "offset"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(whole); i++) {
        struct scene scene;
        struct reason reason = {""};
        assert_int_equal(try_make(whole[i][0], SETTINGS({whole[i][1], 2.5}), 1, &scene, &reason),
                         STATUS_INPUT);
        assert_non_null(strstr(reason.text, "whole"));
        assert_null(scene.vertex);
    }
}

static void too_many_triangles_are_refused(void **state)
{
    (void)state;
    struct scene scene;
    struct reason reason = {""};
    assert_int_equal(try_make("flake", SETTINGS({"depth", 6}, {"n", 64}), 1, &scene, &reason),
                     STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "19591036940 triangles"));
    assert_null(scene.vertex);
}

static void a_million_triangles_are_possible(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        struct setting setting[3];
        uint32_t tri_count;
    } big[] = {
        {"soup", {{"n", 1 << 20}}, 1 << 20},
        {"sphere", {{"n", 362}}, 8 * 362 * 362},
        {"flake", {{"depth", 4}, {"n", 4}}, 12 + 7381 * 128},
        {"terrain", {{"k", 9}}, 2 << 18},
        {"grid", {{"n", 724}}, 2 * 724 * 724},
        {"cornell", {{"n", 170}}, 36 * 170 * 170},
        {"platonic", {{"rows", 13000}}, 80 * 13000},
        {"needles", {{"n", 1 << 20}}, 1 << 20},
        {"stack", {{"n", 1 << 18}}, 4 << 18},
    };
    for (size_t i = 0; i < ARRAY_COUNT(big); i++) {
        struct scene scene = make(big[i].name, big[i].setting, 1);
        assert_int_equal(scene.tri_count, big[i].tri_count);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_names_are_unique_and_found),
        cmocka_unit_test(defaults_are_small_and_complete),
        cmocka_unit_test(defaults_have_the_same_bytes_everywhere),
        cmocka_unit_test(the_seed_changes_what_is_random_only),
        cmocka_unit_test(parameter_borders_hold),
        cmocka_unit_test(counts_must_be_whole),
        cmocka_unit_test(too_many_triangles_are_refused),
        cmocka_unit_test(a_million_triangles_are_possible),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
