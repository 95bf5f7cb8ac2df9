/* The text file of a finding: to the bit there and back, and every broken file refused with its
 * line. */
#define _GNU_SOURCE /* mkstemp */
#include "fuzz/findings/finding_file.h"
#include "ref/base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

static uint32_t rng_u32(struct rng *rng)
{
    return (uint32_t)(rng_u64(rng) >> 32);
}

/* A trial of random bits: every kind of float. */
static struct finding_file random_file(struct rng *rng, uint32_t triangles, uint32_t rays)
{
    struct finding_file file = {0};
    struct fuzz_trial *trial = &file.trial;
    uint32_t vertices = 3 * triangles;
    assert_int_equal(fuzz_trial_make(vertices, triangles, rays, trial, &reason), STATUS_OK);
    for (size_t i = 0; i < 3 * (size_t)vertices; i++)
        do {
            trial->scene.vertex[i] = float_from_bits(rng_u32(rng));
        } while (!float_is_finite(trial->scene.vertex[i]));
    for (size_t i = 0; i < 3 * (size_t)triangles; i++)
        trial->scene.index[i] = rng_u32(rng) % vertices;
    for (size_t i = 0; i < 8 * (size_t)rays; i++)
        ((uint32_t *)trial->ray)[i] =
            i % 5 ? rng_u32(rng) : rng_u32(rng) | 0x7F800000u; /* NaNs of all payloads, infinity */
    if (rays > 0) {
        trial->ray[0].tmin = -0.0f;
        trial->ray[0].tmax = INFINITY;
    }
    trial->origin = (struct fuzz_origin){UINT64_MAX - rng_u32(rng), rng_u32(rng), rng_u32(rng),
                                         rng_u32(rng) % 2, "soup # of 7"};
    trial->builder = builders[rng_u32(rng) % 2];
    trial->build = (struct build_options){.leaf = 1 + rng_u32(rng) % 9, .eps = 0.1f};
    trial->box = box_tests[rng_u32(rng) % 2];
    trial->tri = tri_tests[rng_u32(rng) % 2];
    trial->query = rng_u32(rng) % 2 ? QUERY_ANY : QUERY_CLOSEST;
    file.has_signature = rng_u32(rng) % 4 != 0;
    if (file.has_signature)
        assert_int_equal(
            fuzz_signature_parse("pipe:a.b.rf16.missed.rounded_inward", &file.signature, &reason),
            STATUS_OK);
    strcpy(file.versions, "raydiff 0.1.0\nvulkan: llvmpipe # 22.3.6");
    return file;
}

static void assert_same(const struct finding_file *a, const struct finding_file *b)
{
    const struct fuzz_trial *x = &a->trial, *y = &b->trial;
    assert_int_equal(x->scene.vertex_count, y->scene.vertex_count);
    assert_int_equal(x->scene.tri_count, y->scene.tri_count);
    assert_int_equal(x->ray_count, y->ray_count);
    assert_memory_equal(x->scene.vertex, y->scene.vertex, 12 * (size_t)x->scene.vertex_count);
    assert_memory_equal(x->scene.index, y->scene.index, 12 * (size_t)x->scene.tri_count);
    assert_memory_equal(x->ray, y->ray, sizeof *x->ray * x->ray_count);
    assert_int_equal(fuzz_trial_hash(x), fuzz_trial_hash(y));
    assert_true(x->origin.seed == y->origin.seed && x->origin.index == y->origin.index);
    assert_true(x->origin.version == y->origin.version && x->origin.mutated == y->origin.mutated);
    assert_string_equal(x->origin.recipe, y->origin.recipe);
    assert_int_equal(a->has_signature, b->has_signature);
    assert_true(fuzz_signature_same(&a->signature, &b->signature));
    assert_string_equal(a->versions, b->versions);
}

/* Parses memory of exactly this size, so that the sanitizer sees a step too far. */
static enum status parse(const char *bytes, size_t size, struct finding_file *out)
{
    char *copy = malloc(size + 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    copy[size] = '\0';
    reason.text[0] = '\0';
    enum status status = finding_file_parse("f", copy, size, out, &reason);
    free(copy);
    if (status) {
        assert_null(out->trial.ray);
        assert_null(out->trial.scene.vertex);
        assert_int_equal(strncmp(reason.text, "f:", 2), 0);
        assert_null(strchr(reason.text, '\n'));
    }
    return status;
}

static void files_come_back_to_the_bit(void **state)
{
    (void)state;
    struct rng rng = rng_make(2, 0);
    char path[] = "/tmp/raydiff-test-trial-XXXXXX";
    int made = mkstemp(path);
    assert_true(made >= 0);
    close(made);
    for (uint32_t i = 0; i < 60; i++) {
        struct finding_file file = random_file(&rng, 1 + i % 20, i % 7), again;
        char *bytes;
        size_t size;
        assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
        if (parse(bytes, size, &again))
            fail_msg("%s\n%s", reason.text, bytes);
        assert_same(&file, &again);
        finding_file_free(&again);
        assert_int_equal(finding_file_write(&file, path, &reason), STATUS_OK);
        assert_int_equal(finding_file_read(path, &again, &reason), STATUS_OK);
        assert_same(&file, &again);
        finding_file_free(&again);
        finding_file_free(&file);
        free(bytes);
    }
    unlink(path);
}

/* 4 triangles of 12 vertices and a ray whose every number takes the most digits, and as many
 * versions as fit. */
static void four_triangles_and_a_ray_are_under_4_kB(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 0);
    struct finding_file file = random_file(&rng, 4, 1);
    for (int i = 0; i < 36; i++)
        file.trial.scene.vertex[i] = float_from_bits(0x80800001u + (uint32_t)i);
    for (int i = 0; i < 8; i++)
        ((float *)file.trial.ray)[i] = float_from_bits(0x80800001u + (uint32_t)i);
    memset(file.versions, 'v', 700);
    for (int i = 70; i < 700; i += 70)
        file.versions[i] = '\n';
    file.versions[700] = '\0';
    memset(file.trial.origin.recipe, 'r', sizeof file.trial.origin.recipe - 1);
    char *bytes;
    size_t size;
    assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
    assert_true(size > 1500);
    if (size >= 4096)
        fail_msg("%zu bytes", size);
    free(bytes);
    finding_file_free(&file);
}

static const char sound[] = "# made by hand\n"
                            "raydiff trial 1\n"
                            "\n"
                            "expect cpu.rf16.missed.rounded_inward # so far\n"
                            "with one 1.0\n"
                            "with two # 2.0\n"
                            "query closest\n"
                            "builder median leaf 4 eps 0.02\n"
                            "box robust\n"
                            "tri mt\n"
                            "vertices 4\n"
                            "0 0 0\n"
                            "  1.0 0x0p+0 -0   # a vertex\n"
                            "\t0 1 0\n"
                            "# another\n"
                            "1 1 1e-3\n"
                            "triangles 2\n"
                            "0 1 2\n"
                            "3 2 1\n"
                            "rays 1\n"
                            "0.25 0.25 -1 0 0 1 0 inf\n"
                            "end\n"
                            "# that is all\n";

static void files_are_read_as_people_write_them(void **state)
{
    (void)state;
    struct finding_file file, again;
    if (parse(sound, strlen(sound), &file))
        fail_msg("%s", reason.text);
    assert_string_equal(file.versions, "one 1.0\ntwo # 2.0");
    assert_true(file.has_signature);
    assert_int_equal(file.trial.origin.version, 0);
    assert_int_equal(file.trial.scene.vertex_count, 4);
    assert_int_equal(float_bits(file.trial.scene.vertex[5]), 0x80000000u);
    assert_int_equal(file.trial.scene.index[3], 3);
    assert_true(isinf(file.trial.ray[0].tmax));
    char windows[2 * sizeof sound], *to = windows;
    for (const char *from = sound; *from; from++) {
        if (*from == '\n')
            *to++ = '\r';
        *to++ = *from;
    }
    assert_int_equal(parse(windows, (size_t)(to - windows), &again), STATUS_OK);
    assert_same(&file, &again);
    finding_file_free(&again);
    finding_file_free(&file);
}

/* A file with one place of the sound one replaced must be refused, on this line, for this rule. */
static const struct {
    const char *from, *to;
    int line;
    const char *rule;
} broken[] = {
    {"raydiff trial 1", "trial 1", 2, "'raydiff' is needed here"},
    {"raydiff trial 1", "raydiff trial 3", 2, "format version 3"},
    {"raydiff trial 1", "raydiff trial 1 x", 2, "end of the line"},
    {"expect cpu.rf16.missed.rounded_inward", "expect", 4, "'clean' or a signature"},
    {"expect cpu.rf16.missed.rounded_inward", "expect cpu.rf16.missed.luck", 4, "unknown cause"},
    {"expect cpu.rf16.missed.rounded_inward", "expect ../x.rf16.missed.stack", 4, "no engine's"},
    {"expect cpu.rf16.missed.rounded_inward", "", 11, "a line 'expect' is needed"},
    {"query closest", "query all", 7, "unknown query"},
    {"query closest", "query closest\nquery any", 8, "a second line 'query'"},
    {"builder median", "builder best", 8, "unknown builder 'best'"},
    {"leaf 4", "leaf 0", 8, "leaf is 1 or more"},
    {"leaf 4", "leaf -4", 8, "not a whole number"},
    {"leaf 4", "leaf 4294967296", 8, "from 0 to 4294967295"},
    {"leaf 4 ", "", 8, "'leaf' is needed here"},
    {"eps 0.02", "eps nan", 8, "eps: 'nan' is not a number"},
    {"eps 0.02", "eps -1", 8, "eps is 0 or more"},
    {"eps 0.02", "eps inf", 8, "not finite"},
    {"box robust", "store sand\nbox robust", 9, "unknown storage 'sand'"},
    {"box robust", "optimize 1000\nbox robust", 9, "passes: "},
    {"box robust", "rotate 2\noptimize 1\nbox robust", 10, "optimized in one way"},
    {"box robust", "presplit -1\nbox robust", 9, "how many parts is 0 to 4"},
    {"box robust", "presplit 4.5\nbox robust", 9, "how many parts is 0 to 4"},
    {"box robust", "presplit nan\nbox robust", 9, "how many parts: 'nan'"},
    {"box robust", "move -1 seed 1\nbox robust", 9, "how far is 0 to"},
    {"box robust", "move 1e9 seed 1\nbox robust", 9, "how far is 0 to"},
    {"box robust", "move nan seed 1\nbox robust", 9, "how far: 'nan'"},
    {"box robust", "move 0.5\nbox robust", 9, "'seed' is needed here"},
    {"box robust", "box", 9, "a box test is needed here, not end of line"},
    {"box robust", "box wide", 9, "unknown box test"},
    {"tri mt", "tri exact", 10, "unknown triangle test"},
    {"tri mt", "try mt", 10, "a line 'tri' is needed before 'try'"},
    {"vertices 4", "vertices 3", 16, "'triangles' is needed here"},
    {"vertices 4", "vertices 5", 17, "x: 'triangles' is not a number"},
    {"vertices 4", "vertices 4000000000", 11, "do not fit into the rest"},
    {"vertices 4", "vertices 99999999999999999999", 11, "not a whole number"},
    {"vertices 4", "vertices 0x4", 11, "not a whole number"},
    {"0 0 0\n", "0 0\n", 12, "z is needed here, not end of line"},
    {"0 0 0\n", "0 0 0 0\n", 12, "end of the line is needed here"},
    {"0 0 0\n", "0 nan:0x7fc00000 0\n", 12, "not finite"},
    {"0 0 0\n", "0 -inf 0\n", 12, "not finite"},
    {"0 0 0\n", "0 1e39 0\n", 12, "beyond the range"},
    {"0 0 0\n", "0 0x1.0000001p+0 0\n", 12, "not exactly a 32-bit float"},
    {"0 0 0\n", "0 1,0 0\n", 12, "not a number"},
    {"0 1 2", "0 1 4", 18, "vertex index 4, but there are 4"},
    {"0 1 2", "0 1 -1", 18, "not a whole number"},
    {"0 1 2", "0 1 1.5", 18, "not a whole number"},
    {"0 1 2", "0 1", 18, "vertex index"},
    {"triangles 2", "triangles 3", 20, "vertex index: 'rays'"},
    {"triangles 2", "triangles 1", 19, "'rays' is needed here, not '3'"},
    {"rays 1", "rays 2", 22, "origin x: 'end'"},
    {"rays 1", "rays 100000", 20, "do not fit"},
    {"0 inf", "0", 21, "tmax is needed here"},
    {"0 inf", "0 inf 1", 21, "end of the line"},
    {"0 inf", "0 nan", 21, "tmax: 'nan'"},
    {"end\n", "", 23, "'end' is needed here, not end of file"},
    {"end\n", "end\nend\n", 23, "something follows"},
    {"end\n", "ending\n", 22, "'end' is needed"},
    {"one 1.0", "one \x01", 5, "printable ASCII"},
    {"one 1.0", "one \xC3\xA4", 5, "printable ASCII"},
};

static void broken_files_name_line_and_rule(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(broken); i++) {
        char text[2 * sizeof sound], where[40];
        const char *at = strstr(sound, broken[i].from);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - sound), sound, broken[i].to,
                 at + strlen(broken[i].from));
        struct finding_file file;
        enum status status = parse(text, strlen(text), &file);
        snprintf(where, sizeof where, "f:%d: ", broken[i].line);
        if (status != STATUS_INPUT || strncmp(reason.text, where, strlen(where)) != 0 ||
            !strstr(reason.text, broken[i].rule))
            fail_msg("'%s' for '%s': %d, %s", broken[i].to, broken[i].from, status, reason.text);
    }
}

/* What is over a trial's limits and would fit into the file. */
static void too_large_trials_are_over_a_limit(void **state)
{
    (void)state;
    static const char head[] = "raydiff trial 1\nexpect clean\nbuilder median leaf 4 eps 0\n"
                               "box robust\ntri mt\nquery any\nvertices 0\ntriangles 0\nrays ";
    size_t size = 16 * (FUZZ_RAYS_MOST + 2) + 200;
    char *text = malloc(size);
    assert_non_null(text);
    memset(text, ' ', size);
    int used = snprintf(text, size, "%s%u", head, FUZZ_RAYS_MOST + 1);
    text[used] = '\n';
    struct finding_file file;
    assert_int_equal(parse(text, size, &file), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "f:9: a trial has at most 65536 rays"));
    free(text);
}

/* Cut anywhere, or with any byte changed, a file is refused or is another sound one. */
static void cut_files_are_refused(void **state)
{
    (void)state;
    size_t whole = (size_t)(strstr(sound, "end\n") + 3 - sound);
    struct finding_file file;
    for (size_t size = 0; size < whole; size++)
        assert_int_equal(parse(sound, size, &file), STATUS_INPUT);
    assert_int_equal(parse(sound, whole, &file), STATUS_OK);
    finding_file_free(&file);
}

static void damaged_files_are_refused_or_sound(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 0);
    size_t refused = 0;
    for (int i = 0; i < 20000; i++) {
        char text[sizeof sound], *bytes;
        size_t size;
        memcpy(text, sound, sizeof sound);
        for (uint32_t k = 1 + rng_u32(&rng) % 3; k > 0; k--)
            text[rng_u32(&rng) % (sizeof sound - 1)] =
                (char)(rng_u32(&rng) % 4 ? 32 + rng_u32(&rng) % 95 : rng_u32(&rng) % 256);
        struct finding_file file, again;
        if (parse(text, sizeof sound - 1, &file)) {
            refused++;
            continue;
        }
        assert_int_equal(fuzz_trial_check(&file.trial, &reason), STATUS_OK);
        assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
        assert_int_equal(parse(bytes, size, &again), STATUS_OK);
        assert_same(&file, &again);
        finding_file_free(&again);
        finding_file_free(&file);
        free(bytes);
    }
    assert_true(refused > 5000);
}

/* Text that could be taken for lines of the file. */
static void text_of_people_breaks_no_file(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 0);
    struct finding_file file = random_file(&rng, 1, 1), again;
    char *bytes;
    size_t size;
    strcpy(file.trial.origin.recipe, " a\nend\n\x1b[2J\xff ");
    strcpy(file.versions, "\n\n  one\t1\r\n \n\ntwo\n");
    assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_OK);
    if (parse(bytes, size, &again))
        fail_msg("%s\n%s", reason.text, bytes);
    assert_string_equal(again.versions, "one?1\ntwo");
    assert_string_equal(again.trial.origin.recipe, "a");
    finding_file_free(&again);
    free(bytes);
    strcpy(file.signature.engine, "a/b");
    file.has_signature = true;
    assert_int_equal(finding_file_print(&file, &bytes, &size, &reason), STATUS_INPUT);
    assert_null(bytes);
    finding_file_free(&file);
    assert_int_equal(finding_file_read("/nowhere/x.trial", &file, &reason), STATUS_INPUT);
    assert_int_equal(finding_file_read("/tmp", &file, &reason), STATUS_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_come_back_to_the_bit),
        cmocka_unit_test(four_triangles_and_a_ray_are_under_4_kB),
        cmocka_unit_test(files_are_read_as_people_write_them),
        cmocka_unit_test(broken_files_name_line_and_rule),
        cmocka_unit_test(too_large_trials_are_over_a_limit),
        cmocka_unit_test(cut_files_are_refused),
        cmocka_unit_test(damaged_files_are_refused_or_sound),
        cmocka_unit_test(text_of_people_breaks_no_file),
    };
    return cmocka_run_group_tests_name("fuzz_files", tests, NULL, NULL);
}
