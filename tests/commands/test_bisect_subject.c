/* What raydiff bisect takes from a trial's name and from a finding's file: each of its members, and
 * nothing else. */
#define _GNU_SOURCE
#include "cmd/bisect/cmd_bisect.h"

#include "cmd/conform/cmd_trial.h"
#include "scenes/move.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* As the command begins, with members that no case names. */
static struct bisect_options options_made(void)
{
    return (struct bisect_options){.bad = "opt",
                                   .good = "raw",
                                   .engine = engine_find("vulkan_brute"),
                                   .layout = layout_find("half4"),
                                   .builder = builder_find("ploc"),
                                   .query = QUERY_ALL,
                                   .rays = ray_sets[0],
                                   .count = 3,
                                   .seed = 99};
}

/* False if what optimises shaders is missing here. */
static bool opens(struct bisect_options *o, const char *text, struct bisect_subject *subject)
{
    struct reason reason;
    const enum status status = bisect_subject_open(o, text, subject, &reason);
    if (status == STATUS_UNSUPPORTED)
        return false;
    if (status)
        fail_msg("%s: %s", text, reason.text);
    return true;
}

static void brought(const struct trial *trial)
{
    char name[TRIAL_NAME_MOST];
    struct bisect_subject subject;
    struct bisect_options o = options_made();
    trial_print(trial, name);
    if (!opens(&o, name, &subject))
        skip();
    assert_ptr_equal(o.engine, trial->engine);
    assert_ptr_equal(o.layout, trial->layout);
    assert_ptr_equal(o.store, trial->store);
    assert_ptr_equal(o.builder, trial->builder);
    assert_ptr_equal(o.box, trial->box);
    assert_ptr_equal(o.tri, trial->tri);
    assert_int_equal(o.query, trial->query);
    assert_ptr_equal(o.rays, trial->rays);
    assert_int_equal(o.seed, trial->seed);
    assert_int_equal(subject.ray_count, 3);
    bisect_subject_free(&subject);
}

static void a_name_brings_each_of_its_members(void **state)
{
    (void)state;
    const struct trial first = {.query = QUERY_CLOSEST,
                                .engine = engine_find("vulkan"),
                                .layout = layout_find("f32"),
                                .store = tri_stores[0],
                                .builder = builders_all[0],
                                .box = box_tests[0],
                                .tri = tri_tests[0],
                                .rays = ray_sets[0],
                                .seed = 7,
                                .scene = "soup:n=9"};
    struct trial trial = first;
    brought(&trial);
    trial.query = QUERY_ANY;
    brought(&trial);
    trial.seed = 8;
    brought(&trial);
    trial.engine = engine_find("vulkan_stackless");
    brought(&trial);
    for (size_t i = 0; builders_all[i]; i++, trial = first) {
        trial.builder = builders_all[i];
        brought(&trial);
    }
    for (size_t i = 0; box_tests[i]; i++, trial = first) {
        trial.box = box_tests[i];
        brought(&trial);
    }
    for (size_t i = 0; tri_tests[i]; i++, trial = first) {
        trial.tri = tri_tests[i];
        brought(&trial);
    }
    for (size_t i = 0; ray_sets[i]; i++, trial = first) {
        trial.rays = ray_sets[i];
        brought(&trial);
    }
    for (size_t i = 0; layouts[i]; i++, trial = first) {
        trial.layout = layouts[i];
        brought(&trial);
    }
    for (size_t i = 0; tri_stores[i]; i++, trial = first) {
        trial.store = tri_stores[i];
        brought(&trial);
    }
}

static void a_file_brings_each_of_its_members(void **state)
{
    (void)state;
    glob_t found;
    size_t opened = 0;
    assert_int_equal(glob("fuzz/corpus/*.trial", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        struct reason reason;
        struct finding_file file;
        struct bisect_subject subject;
        struct bisect_options o = options_made();
        assert_int_equal(finding_file_read(found.gl_pathv[i], &file, &reason), STATUS_OK);
        if (!opens(&o, found.gl_pathv[i], &subject))
            skip();
        assert_ptr_equal(o.store, file.trial.store);
        assert_ptr_equal(o.builder, file.trial.builder);
        assert_int_equal(o.build.leaf, file.trial.build.leaf);
        assert_true(o.build.eps == file.trial.build.eps);
        assert_ptr_equal(o.box, file.trial.box);
        assert_ptr_equal(o.tri, file.trial.tri);
        assert_int_equal(o.query, file.trial.query);
        assert_int_equal(subject.ray_count, file.trial.ray_count);
        assert_memory_equal(subject.ray, file.trial.ray, subject.ray_count * sizeof *subject.ray);
        assert_int_equal(subject.scene.tri_count, file.trial.scene.tri_count);
        assert_int_equal(subject.is_world != NULL, file.trial.world.is);
        assert_int_equal(subject.moved, file.trial.move > 0);
        if (file.trial.world.is)
            assert_memory_equal(subject.mode, file.trial.world.mode,
                                subject.ray_count * sizeof *subject.mode);
        bisect_subject_free(&subject);
        finding_file_free(&file);
        opened++;
    }
    assert_in_range(opened, 10, 1000);
    globfree(&found);
}

/* The tree is built of a scene at rest, as fuzz has it: moved by the file's distance and seed. */
static void a_scene_at_rest_is_that_of_the_file(void **state)
{
    (void)state;
    static const struct {
        float move;
        uint64_t seed;
    } moves[] = {{0.0f, 5}, {0x1p-3f, 7}, {0x1p-3f, 8}, {2.0f, 7}, {0x1p-9f, 1ull << 40}};
    char path[] = "/tmp/raydiff-test-bisect-XXXXXX.trial";
    const int made = mkstemps(path, 6);
    assert_true(made >= 0);
    close(made);
    for (size_t i = 0; i < ARRAY_COUNT(moves); i++) {
        struct reason reason;
        struct finding_file file;
        struct bisect_subject subject;
        struct bisect_options o = options_made();
        const enum status status =
            finding_file_read("fuzz/corpus/eighth-slot.trial", &file, &reason);
        assert_int_equal(status, STATUS_OK);
        file.trial.move = moves[i].move;
        file.trial.move_seed = moves[i].seed;
        assert_int_equal(finding_file_write(&file, path, &reason), STATUS_OK);
        if (!opens(&o, path, &subject))
            skip();
        struct scene *rest = &file.trial.scene;
        const size_t bytes = 3 * sizeof(float) * rest->vertex_count;
        assert_memory_equal(subject.scene.vertex, rest->vertex, bytes);
        assert_int_equal(subject.moved, moves[i].move > 0);
        scene_move(rest, moves[i].move, moves[i].seed);
        if (subject.moved) {
            assert_memory_equal(subject.rest.vertex, rest->vertex, bytes);
            assert_memory_not_equal(subject.scene.vertex, rest->vertex, bytes);
            assert_int_equal(subject.rest.vertex_count, rest->vertex_count);
            assert_int_equal(subject.rest.tri_count, rest->tri_count);
        }
        bisect_subject_free(&subject);
        finding_file_free(&file);
    }
    unlink(path);
}

/* Compilers that compile alike are the same, however they are named. */
static void two_compilers_are_not_the_same(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int is;
    } named[] = {{"raw", 0},
                 {"raw:source", 0},
                 {"raw:none", 1},
                 {"opt", 2},
                 {"opt:source", 2},
                 {"opt:final", 3},
                 {"size", 4},
                 {"passes:ccp", 5},
                 {"passes:ccp:source", 5},
                 {"passes:ccp:none", 6}};
    for (size_t i = 0; i < ARRAY_COUNT(named); i++)
        for (size_t k = 0; k < ARRAY_COUNT(named); k++) {
            struct bisect_options o = options_made();
            struct bisect_subject subject = {0};
            struct reason reason = {""};
            o.query = QUERY_CLOSEST;
            o.engine = engine_find("vulkan");
            o.layout = layout_find("f32");
            o.bad = named[i].text;
            o.good = named[k].text;
            const enum status status = bisect_subject_open(&o, "soup:n=9", &subject, &reason);
            bisect_subject_free(&subject); /* of a fault, too */
            if (status == STATUS_UNSUPPORTED)
                skip();
            assert_int_equal(status, named[i].is == named[k].is ? STATUS_INPUT : STATUS_OK);
            assert_int_equal(strstr(reason.text, "it is the same compiler") != NULL,
                             named[i].is == named[k].is);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_name_brings_each_of_its_members),
        cmocka_unit_test(a_file_brings_each_of_its_members),
        cmocka_unit_test(a_scene_at_rest_is_that_of_the_file),
        cmocka_unit_test(two_compilers_are_not_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
