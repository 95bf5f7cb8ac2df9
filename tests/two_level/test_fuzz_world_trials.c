/* Trials of worlds as values and as text: copies, hashes, what no reader may let through. */
#include "fuzz/campaign/worker_base.h"
#include "fuzz/gen/gen.h"
#include "fuzz/play/player.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/two_level/fuzz_world_play.h"

static const struct gen_options usual = {
    .triangles_least = 16, .triangles_most = 64, .rays = 20, .worlds = true};
static const struct gen_options of_scenes = {
    .triangles_least = 16, .triangles_most = 64, .rays = 20};

/* Two triangles in two meshes, the first mesh of two geometries; two instances, two rays. */
static struct fuzz_trial make(void)
{
    struct reason reason;
    struct fuzz_trial trial;
    assert_int_equal(fuzz_trial_make(3, 2, 2, &trial, &reason), STATUS_OK);
    trial.scene.vertex[0] = trial.scene.vertex[4] = 1;
    static const uint32_t index[] = {0, 1, 2, 2, 1, 0};
    memcpy(trial.scene.index, index, sizeof index);
    trial.ray[0].dir[2] = trial.ray[1].dir[2] = 1;
    assert_int_equal(trial_world_make(2, 3, 2, 2, &trial.world, &reason), STATUS_OK);
    trial.world.geometry[0].count = 1;
    trial.world.geometry[2] = (struct trial_geometry){1, 1, false};
    trial.world.instance[1].mesh = 1;
    trial.world.instance[1].m[0][3] = 2;
    assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_OK);
    return trial;
}

static void a_new_world_is_plain(void **state)
{
    (void)state;
    struct reason reason;
    struct trial_world world;
    assert_int_equal(trial_world_make(5, 1, 3, 2, &world, &reason), STATUS_OK);
    assert_int_equal(world.geometry[0].count, 5);
    assert_int_equal(trial_world_places(&world), 0);
    assert_int_equal(trial_world_weight(&world, 2), 1); /* its geometry */
    assert_int_equal(world.instance[2].mask, 0xFF);
    trial_world_free(&world);
    static const uint32_t over[][2] = {{FUZZ_GEOMETRIES_MOST + 1, 0}, {0, FUZZ_INSTANCES_MOST + 1}};
    for (size_t i = 0; i < ARRAY_COUNT(over); i++) {
        assert_int_equal(trial_world_make(0, over[i][0], over[i][1], 0, &world, &reason),
                         STATUS_LIMIT);
        assert_false(world.is);
    }
}

/* What decides, word by word: geometries, instances, modes, filter. */
static void the_hash_has_all_of_a_world(void **state)
{
    (void)state;
    struct fuzz_trial trial = make();
    struct trial_world *world = &trial.world;
    uint64_t plain = fuzz_trial_hash(&trial);
    uint32_t *words[64];
    size_t count = 0;
    for (uint32_t i = 0; i < 3; i++) {
        words[count++] = &world->geometry[i].mesh;
        words[count++] = &world->geometry[i].count;
    }
    for (uint32_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < sizeof *world->instance / 4; k++)
            words[count++] = (uint32_t *)&world->instance[i] + k;
        words[count++] = &world->mode[i].mask;
        words[count++] = &world->mode[i].flags;
    }
    words[count++] = &world->filter.seed;
    words[count++] = &world->filter.share;
    for (size_t i = 0; i < count; i++)
        for (int bit = 0; bit < 32; bit++) {
            *words[i] ^= 1u << bit;
            assert_int_not_equal(fuzz_trial_hash(&trial), plain);
            *words[i] ^= 1u << bit;
        }
    world->geometry[1].opaque = false;
    assert_int_not_equal(fuzz_trial_hash(&trial), plain);
    world->geometry[1].opaque = true;
    world->filter.kind = FILTER_NONE;
    assert_int_not_equal(fuzz_trial_hash(&trial), plain);
    world->filter.kind = FILTER_ALL;
    assert_int_equal(fuzz_trial_hash(&trial), plain);
    world->is = false;
    assert_int_not_equal(fuzz_trial_hash(&trial), plain);
    world->is = true;
    fuzz_trial_free(&trial);
}

static void copies_and_bytes_are_deep(void **state)
{
    (void)state;
    struct reason reason;
    struct finding_file file = {.trial = make()}, again;
    struct fuzz_trial copy;
    file.trial.world.mode[1] = (struct ray_mode){5, ABI_RAY_FIRST};
    file.trial.world.filter.seed = 3;
    uint64_t hash = fuzz_trial_hash(&file.trial);
    assert_int_equal(fuzz_trial_copy(&file.trial, &copy, &reason), STATUS_OK);
    size_t size = worker_base_bytes(&file);
    char *bytes = malloc(size);
    assert_non_null(bytes);
    worker_base_put(&file, bytes);
    assert_int_equal(worker_base_get(bytes, size, &again, &reason), STATUS_OK);
    struct finding_file cut;
    assert_int_equal(worker_base_get(bytes, size - 1, &cut, &reason), STATUS_INPUT);
    assert_null(cut.trial.world.instance);
    memset(bytes, 0xFF, size);
    assert_int_equal(fuzz_trial_hash(&again.trial), hash);
    memset(again.trial.world.instance, 0, sizeof *again.trial.world.instance);
    memset(again.trial.world.geometry, 0, sizeof *again.trial.world.geometry);
    memset(again.trial.world.mode, 0, sizeof *again.trial.world.mode);
    assert_int_equal(fuzz_trial_hash(&copy), hash);
    finding_file_free(&again);
    finding_file_free(&file);
    fuzz_trial_free(&copy);
    free(bytes);
}

/* Bytes hold each array, however long it is beside the others. */
static void bytes_of_any_counts(void **state)
{
    (void)state;
    struct reason reason;
    for (uint32_t n = 0; n < 4 * 4 * 4; n++) {
        const uint32_t geometries = 1 + n % 4, instances = 1 + n / 4 % 4 * 3, rays = 1 + n / 16 * 5;
        struct finding_file file = {0}, again;
        assert_int_equal(fuzz_trial_make(3, 2, rays, &file.trial, &reason), STATUS_OK);
        struct trial_world *world = &file.trial.world;
        assert_int_equal(trial_world_make(2, geometries, instances, rays, world, &reason),
                         STATUS_OK);
        world->geometry[geometries - 1].opaque = false;
        world->instance[instances - 1].custom = 7;
        world->mode[rays - 1].mask = 9;
        file.trial.ray[rays - 1].dir[1] = 3;
        size_t size = worker_base_bytes(&file);
        char *bytes = malloc(size);
        assert_non_null(bytes);
        worker_base_put(&file, bytes);
        assert_int_equal(worker_base_get(bytes, size, &again, &reason), STATUS_OK);
        assert_int_equal(fuzz_trial_hash(&again.trial), fuzz_trial_hash(&file.trial));
        finding_file_free(&again);
        finding_file_free(&file);
        free(bytes);
    }
}

/* The view of the rays from one on has their modes. */
static void rays_keep_their_modes(void **state)
{
    (void)state;
    struct fuzz_trial trial = make();
    trial.world.mode[1].mask = 7;
    struct fuzz_trial part = fuzz_trial_rays_from(&trial, 1, 1);
    assert_int_equal(part.ray_count, 1);
    assert_ptr_equal(part.ray, trial.ray + 1);
    assert_int_equal(part.world.mode[0].mask, 7);
    fuzz_trial_free(&trial);
}

/* One change that makes the trial above invalid, and its error. */
static void break_it(struct fuzz_trial *trial, uint32_t how)
{
    struct trial_world *world = &trial->world;
    uint32_t *const words[] = {
        &world->geometry[0].mesh,  &world->geometry[2].mesh,  &world->geometry[0].count,
        &world->instance[0].mesh,  &world->instance[0].mask,  &world->instance[0].custom,
        &world->instance[0].flags, &world->instance[0].flags, &world->mode[1].mask,
        &world->mode[1].flags,     &world->filter.share};
    static const uint32_t values[] = {1, 2, 2, 2, 256, 1u << 24, 16, 12, 256, 3, 257};
    if (how < ARRAY_COUNT(words))
        *words[how] = values[how];
    else if (how == ARRAY_COUNT(words))
        world->instance[1].m[1][1] = 0; /* singular */
    else if (how == ARRAY_COUNT(words) + 1)
        world->instance[1].m[0][3] = (float)INFINITY;
    else if (how == ARRAY_COUNT(words) + 2)
        trial->move = 1;
    else
        world->filter.kind = (enum filter_kind)4;
}

static void what_is_no_world_is_refused(void **state)
{
    (void)state;
    static const char *const says[] = {"of mesh 1: meshes are numbered",
                                       "of mesh 2: meshes are",
                                       "have 3 triangles, the trial",
                                       "mesh 2, but the world has 2",
                                       "mask 256",
                                       "custom index 16777216",
                                       "flags 0x10",
                                       "forced to be opaque and not",
                                       "ray 1: ray mask 256",
                                       "ray 1: ray flags 0x3",
                                       "share of 257",
                                       "singular",
                                       "not finite",
                                       "does not move",
                                       "kind 4"};
    for (uint32_t i = 0; i < ARRAY_COUNT(says); i++) {
        struct fuzz_trial trial = make();
        struct reason reason = {""};
        break_it(&trial, i);
        assert_int_equal(fuzz_trial_check(&trial, &reason), STATUS_INPUT);
        if (!strstr(reason.text, says[i]))
            fail_msg("'%s' is not in: %s", says[i], reason.text);
        fuzz_trial_free(&trial);
    }
}

/* --- text ------------------------------------------------------------------------------------- */

static void text_comes_back_to_the_bit(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 300; i++) {
        struct reason reason = {""};
        struct finding_file file = {.trial = trial_of(3, i, &usual)}, again;
        char *bytes, *second;
        size_t size, second_size;
        assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
        assert_int_equal(strncmp(bytes, "raydiff trial 2\n", 16), 0);
        if (finding_file_parse("f", bytes, size, &again, &reason))
            fail_msg("%s\n%s", reason.text, bytes);
        assert_int_equal(fuzz_trial_hash(&file.trial), fuzz_trial_hash(&again.trial));
        struct fuzz_trial_size a = fuzz_trial_size(&file.trial), b = fuzz_trial_size(&again.trial);
        assert_true(fuzz_trial_size_compare(&a, &b) == 0 && a.bits == b.bits);
        assert_int_equal(finding_file_print(&again, &second, &second_size, &reason), STATUS_OK);
        assert_string_equal(bytes, second);
        free(bytes);
        free(second);
        finding_file_free(&file);
        finding_file_free(&again);
    }
}

/* A line of the text in another form, and the reader's one line on it. */
static void every_broken_line_is_named(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"raydiff trial 2", "raydiff trial 1", "f:8: filters are of worlds"},
        {"raydiff trial 2", "raydiff trial 3", "f:1: format version 3"},
        {"filter all", "filter most", "f:8: unknown filter 'most'"},
        {"share 128", "share 257", "f:8: share: '257' is not a whole number from 0 to 256"},
        {"query closest", "query closest\nmove 0x1p+0 seed 1", "does not move"},
        {"geometries 3", "geometries 65", "f:16: "},
        {"mesh 1 triangles", "mash 1 triangles", "f:19: 'mesh' is needed here"},
        {"1 filtered", "1 hidden", "f:19: a geometry is opaque or filtered, not 'hidden'"},
        {"mesh 1 triangles", "mesh 2 triangles", "meshes are numbered"},
        {"instances 2", "instances 3", "f:23: mesh, or '-'"},
        {"0 0 255 0 ", "- 0 256 0 ", "f:21: mask: '256' is not a whole number from 0 to 255"},
        {"0 0 255 0 ", "0 0 255 16 ", "f:21: flags: '16' is not a whole number from 0 to 15"},
        {"0 0 255 0 ", "0 0 255 0 nan:0x7fc00000 ", "f:21: a number of a transform: "},
        {"0 0 255 0 ", "0 0 255 0 0x0p+0 ", "f:21: the end of the line"},
        {"inf             255 0", "inf             255", "f:24: flags: "},
        {"inf             255 0", "inf             255 0 0", "f:24: the end of the line"},
    };
    struct reason reason = {""};
    struct finding_file file = {.trial = make()};
    char *bytes;
    size_t size;
    file.trial.ray[0].tmax = file.trial.ray[1].tmax = (float)INFINITY;
    assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        char text[4096];
        const char *at = strstr(bytes, cases[i][0]);
        assert_non_null(at);
        int length = snprintf(text, sizeof text, "%.*s%s%s", (int)(at - bytes), bytes, cases[i][1],
                              at + strlen(cases[i][0]));
        assert_true(length > 0 && (size_t)length < sizeof text);
        struct finding_file again;
        enum status status = finding_file_parse("f", text, (size_t)length, &again, &reason);
        assert_true(status == STATUS_INPUT || status == STATUS_LIMIT);
        assert_null(again.trial.world.instance);
        if (!strstr(reason.text, cases[i][2]) || strchr(reason.text, '\n'))
            fail_msg("'%s' is not in: %s\n%s", cases[i][2], reason.text, text);
    }
    free(bytes);
    finding_file_free(&file);
}

/* A version 1 file has no world, and a trial of a scene is written as one. */
static void scenes_keep_version_1(void **state)
{
    (void)state;
    struct reason reason;
    struct finding_file file = {.trial = trial_of(3, 0, &of_scenes)};
    char *bytes;
    size_t size;
    assert_false(file.trial.world.is);
    assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
    assert_int_equal(strncmp(bytes, "raydiff trial 1\n", 16), 0);
    assert_null(strstr(bytes, "instances"));
    struct finding_file again;
    assert_int_equal(finding_file_parse("f", bytes, size, &again, &reason), STATUS_OK);
    struct fuzz_trial_size one = fuzz_trial_size(&file.trial), two = fuzz_trial_size(&again.trial);
    assert_int_equal(fuzz_trial_size_compare(&one, &two), 0);
    assert_true(one.bits == two.bits);
    finding_file_free(&again);
    free(bytes);
    finding_file_free(&file);
}

/* What stands beside the judge's line: placed triangle 2 of three is the last of its mesh. */
static void a_finding_has_its_place(void **state)
{
    (void)state;
    struct fuzz_trial trial = make();
    char text[600];
    trial.world.instance[0].mesh = 1;
    trial.world.instance[1].mesh = 0;
    trial.world.geometry[1].count = 1;
    trial.world.geometry[2].count = 0;
    trial.world.mode[1] = (struct ray_mode){0x21, ABI_RAY_CULL_BACK};
    struct fuzz_finding finding = {.ray = 1,
                                   .answer = {.prim = 1},
                                   .tag = 7 | ABI_TAG_FRONT,
                                   .judgement = {.verdict = VERDICT_WRONG, .expected = 0}};
    fuzz_finding_line(&trial, &finding, text, sizeof text);
    assert_non_null(strstr(text, "; mask 0x21 flags 0x10, got instance 1 geometry 1 triangle 0 "
                                 "custom 7 front, expected instance 1 geometry 0 triangle 0"));
    finding.answer.prim = 2;
    finding.tag = 0;
    finding.judgement.expected = ABI_NO_PRIM;
    fuzz_finding_line(&trial, &finding, text, sizeof text);
    assert_non_null(strstr(text, "got no triangle of the world custom 0 back, expected nothing"));
    fuzz_trial_free(&trial);
}

/* --- sizes ------------------------------------------------------------------------------------ */

/* Each is smaller than the one before it. */
static void what_is_plainer_is_smaller(void **state)
{
    (void)state;
    struct fuzz_trial trial = make();
    struct instance *one = &trial.world.instance[0];
    static const float places[][12] = {
        {1, 0.5f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, {3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
        {-2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},   {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
        {1, 0, 0, 0.3f, 0, 1, 0, 0, 0, 0, 1, 0}, {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0},
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    struct fuzz_trial_size before = {.instances = 3}, size;
    one->mask = 1;
    one->flags = 1;
    one->custom = 9;
    for (size_t i = 0; i < ARRAY_COUNT(places); i++, before = size) {
        memcpy(one->m, places[i], sizeof one->m);
        size = fuzz_trial_size(&trial);
        assert_true(fuzz_trial_size_compare(&size, &before) < 0);
    }
    uint32_t *const words[] = {&one->flags, &one->custom, &one->mask, &trial.world.mode[0].flags};
    static const uint32_t values[] = {0, 0, 0xFF, 0};
    trial.world.mode[0].flags = ABI_RAY_CULL_BACK;
    before = fuzz_trial_size(&trial);
    for (size_t i = 0; i < ARRAY_COUNT(words); i++, before = size) {
        *words[i] = values[i];
        size = fuzz_trial_size(&trial);
        assert_true(fuzz_trial_size_compare(&size, &before) < 0);
    }
    trial.world.geometry[2].opaque = true;
    size = fuzz_trial_size(&trial);
    assert_true(fuzz_trial_size_compare(&size, &before) < 0);
    fuzz_trial_free(&trial);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_world_is_plain),       cmocka_unit_test(the_hash_has_all_of_a_world),
        cmocka_unit_test(copies_and_bytes_are_deep),  cmocka_unit_test(bytes_of_any_counts),
        cmocka_unit_test(rays_keep_their_modes),      cmocka_unit_test(what_is_no_world_is_refused),
        cmocka_unit_test(text_comes_back_to_the_bit), cmocka_unit_test(every_broken_line_is_named),
        cmocka_unit_test(scenes_keep_version_1),      cmocka_unit_test(a_finding_has_its_place),
        cmocka_unit_test(what_is_plainer_is_smaller),
    };
    return cmocka_run_group_tests_name("fuzz_world_trials", tests, NULL, NULL);
}
