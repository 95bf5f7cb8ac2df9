/* Laws of ref/library/raydiff.h: triangles, exact answers, trees, hard rays, errors. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/library/raydiff.h"
#include "ref/plugin.h" /* both in one file */

#include "ref/base/rng.h"
#include "ref/oracle/oracle.h"
#include "ref/packed/packed_file.h"
#include "scenes/rays/rays.h"

#include <math.h>
#include <stdarg.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/library/library_fixture.h"

#define RAYS 20000u

static struct raydiff_why why;

#define ASSERT_REFUSED(error, words, call)                                                         \
    do {                                                                                           \
        strcpy(why.line, "?");                                                                     \
        assert_int_equal(call, error);                                                             \
        if (!strstr(why.line, words))                                                              \
            fail_msg("'%s' does not have '%s'", why.line, words);                                  \
    } while (0)
#define ASSERT_INPUT(words, call) ASSERT_REFUSED(RAYDIFF_ERROR_INPUT, words, call)

static void the_version_is_that_of_the_program(void **state)
{
    (void)state;
    char text[32];
    const uint32_t version = raydiff_version();
    snprintf(text, sizeof text, "%u.%u.%u", version >> 16, version >> 8 & 0xFF, version & 0xFF);
    assert_string_equal(text, RAYDIFF_VERSION);
}

static void numbers_past_the_last_have_no_name(void **state)
{
    (void)state;
    assert_string_equal(raydiff_verdict_name(RAYDIFF_VERDICT_RIGHT), "right");
    assert_string_equal(raydiff_verdict_name(RAYDIFF_VERDICT_OUT_OF_CONTRACT), "out_of_contract");
    assert_string_equal(raydiff_verdict_name(RAYDIFF_VERDICT_WRONG), "wrong");
    assert_null(raydiff_verdict_name(RAYDIFF_VERDICTS));
    assert_string_equal(raydiff_fault_name(RAYDIFF_FAULT_MISSED), "missed");
    assert_string_equal(raydiff_fault_name(RAYDIFF_FAULT_NOT_FINITE), "not_finite");
    assert_null(raydiff_fault_name(RAYDIFF_FAULTS));
    assert_string_equal(raydiff_class_name(RAYDIFF_CLASS_IN_PLANE), "in_plane");
    assert_null(raydiff_class_name(RAYDIFF_CLASS_IN_PLANE + 1));
    assert_string_equal(raydiff_rays_name(0), "mixed");
    uint32_t sets = 0;
    while (raydiff_rays_name(sets))
        assert_string_equal(raydiff_rays_name(sets), ray_sets[sets]->name), sets++;
    assert_null(ray_sets[sets]);
    assert_null(raydiff_rays_name(UINT32_MAX));
}

static void wrong_triangles_are_named(void **state)
{
    (void)state;
    struct raydiff_oracle *oracle = (struct raydiff_oracle *)(uintptr_t)1;
    const uint32_t beyond[] = {0, 1, 2, 0, 3, 1};
    const float nan[] = {0, 0, 0, 4, 0, 0, 0, NAN, 0};
    ASSERT_INPUT("triangle 1: vertex index 3",
                 raydiff_oracle_make(library_vertex, 3, beyond, 2, &oracle, &why));
    assert_null(oracle);
    ASSERT_INPUT("vertex 2: coordinate y is not finite",
                 raydiff_oracle_make(nan, 3, library_index, 1, &oracle, &why));
    ASSERT_INPUT("vertices: is NULL",
                 raydiff_oracle_make(NULL, 3, library_index, 1, &oracle, &why));
    ASSERT_INPUT("indices: is NULL",
                 raydiff_oracle_make(library_vertex, 3, NULL, 1, &oracle, &why));
    ASSERT_INPUT("out: is NULL",
                 raydiff_oracle_make(library_vertex, 3, library_index, 1, NULL, &why));
    raydiff_oracle_free(NULL);
}

static void no_triangles_are_hit_by_nothing(void **state)
{
    (void)state;
    struct raydiff_oracle *oracle;
    const float ray[] = {1, 1, 1, 0, 0, 0, -1, 2};
    struct raydiff_nearest exact;
    assert_int_equal(raydiff_oracle_make(NULL, 0, NULL, 0, &oracle, NULL), RAYDIFF_ERROR_NONE);
    assert_int_equal(raydiff_exact(oracle, ray, NULL, 1, 1, &exact, NULL), RAYDIFF_ERROR_NONE);
    assert_int_equal(exact.triangle, RAYDIFF_NOTHING);
    assert_int_equal(exact.ties, 0);
    assert_true(exact.t_lo == 0 && exact.t_hi == 0 && isinf(exact.t_next));
    assert_int_equal(raydiff_exact(oracle, NULL, NULL, 0, 1, NULL, NULL), RAYDIFF_ERROR_NONE);
    raydiff_oracle_free(oracle);
}

/* The arrays are the caller's again after the call. */
static void triangles_are_copied(void **state)
{
    (void)state;
    float *vertex = malloc(sizeof library_vertex);
    uint32_t *index = malloc(sizeof library_index);
    struct raydiff_oracle *oracle;
    struct raydiff_nearest exact;
    const float ray[] = {1, 1, 1, 0, 0, 0, -1, 2};
    memcpy(vertex, library_vertex, sizeof library_vertex);
    memcpy(index, library_index, sizeof library_index);
    assert_int_equal(raydiff_oracle_make(vertex, 3, index, 1, &oracle, NULL), RAYDIFF_ERROR_NONE);
    memset(vertex, 0xFF, sizeof library_vertex);
    memset(index, 0xFF, sizeof library_index);
    free(vertex);
    free(index);
    assert_int_equal(raydiff_exact(oracle, ray, NULL, 1, 1, &exact, NULL), RAYDIFF_ERROR_NONE);
    assert_int_equal(exact.triangle, 0);
    assert_int_equal(exact.kind, RAYDIFF_CLASS_INSIDE);
    assert_true(exact.t_lo <= 1 && exact.t_hi >= 1 && exact.t_hi - exact.t_lo <= 0x1p-40);
    raydiff_oracle_free(oracle);
}

static void exact_answers_are_the_oracles_on_any_threads(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("soup:n=300");
    struct ray *ray;
    struct oracle *oracle;
    struct oracle_answer *truth = calloc(RAYS, sizeof *truth);
    struct raydiff_nearest *exact = calloc(RAYS, sizeof *exact),
                           *again = calloc(RAYS, sizeof *again);
    assert_int_equal(ray_set_new(ray_sets[0], &stand.scene, 5, RAYS, &ray, NULL), STATUS_OK);
    assert_int_equal(oracle_make(&stand.scene, &oracle, NULL), STATUS_OK);
    ray[7].org[1] = NAN; /* refused, and told */
    assert_int_equal(
        oracle_closest(oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, RAYS, 0, truth, NULL, NULL),
        STATUS_OK);
    assert_int_equal(raydiff_exact(stand.oracle, ray->org, NULL, RAYS, 0, exact, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_int_equal(raydiff_exact(stand.oracle, ray->org, NULL, RAYS, 1, again, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_memory_equal(exact, again, RAYS * sizeof *exact);
    for (size_t i = 0; i < RAYS; i++) {
        assert_int_equal(exact[i].triangle, truth[i].prim);
        assert_int_equal(exact[i].ties, truth[i].tie_count);
        assert_int_equal(exact[i].kind, truth[i].class);
        assert_int_equal(exact[i].refused, i == 7);
        if (truth[i].prim != ABI_NO_PRIM)
            assert_true(exact[i].t_lo <= truth[i].t_hi && truth[i].t_lo <= exact[i].t_hi &&
                        exact[i].t_lo <= exact[i].t_hi && exact[i].t_next >= exact[i].t_lo);
        else
            assert_true(exact[i].t_lo == 0 && exact[i].t_hi == 0);
    }
    ASSERT_INPUT("rays: is NULL", raydiff_exact(stand.oracle, NULL, NULL, 1, 0, exact, &why));
    assert_int_equal(exact[0].triangle | exact[0].ties, 0);
    ASSERT_INPUT("out: is NULL", raydiff_exact(stand.oracle, ray->org, NULL, 1, 0, NULL, &why));
    ASSERT_INPUT("oracle: is NULL", raydiff_exact(NULL, ray->org, NULL, 1, 0, exact, &why));
    oracle_free(oracle);
    free(truth);
    free(exact);
    free(again);
    free(ray);
    library_stand_free(&stand);
}

static void all_hits_stand_in_the_order_of_t(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("sphere:n=8");
    const float ray[] = {0.01f, 0.02f, -9, 0, 0, 0, 1, 100};
    struct raydiff_crossing list[8];
    struct raydiff_nearest exact;
    size_t found = 99;
    assert_int_equal(raydiff_exact_all(stand.oracle, ray, 8, list, &found, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_int_equal(found, 2);
    assert_int_equal(raydiff_exact(stand.oracle, ray, NULL, 1, 0, &exact, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_int_equal(list[0].triangle, exact.triangle);
    assert_int_equal(list[0].kind, RAYDIFF_CLASS_INSIDE);
    assert_true(list[0].t_lo == exact.t_lo && list[1].t_lo > list[0].t_hi);
    assert_true(list[1].t_lo >= exact.t_next);
    assert_int_equal(list[2].triangle, 0);
    /* A count beyond the capacity is the whole one. */
    list[1].triangle = 7777;
    assert_int_equal(raydiff_exact_all(stand.oracle, ray, 1, list, &found, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_int_equal(found, 2);
    assert_int_equal(list[0].triangle, exact.triangle);
    assert_int_equal(list[1].triangle, 7777);
    assert_int_equal(raydiff_exact_all(stand.oracle, ray, 0, NULL, &found, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_int_equal(found, 2);
    const float refused[] = {0, 0, 0, 2, 0, 0, 1, 1};
    ASSERT_INPUT("tmin is over tmax",
                 raydiff_exact_all(stand.oracle, refused, 8, list, &found, &why));
    assert_int_equal(found, 0);
    library_stand_free(&stand);
}

static void a_fraction_is_exact(void **state)
{
    (void)state;
    struct raydiff_oracle *oracle = library_one();
    const float third[] = {1, 1, 1, 0, 0, 0, -3, 2}, beside[] = {9, 9, 1, 0, 0, 0, -3, 2};
    char text[2048];
    assert_int_equal(raydiff_exact_text(oracle, third, 0, text, sizeof text, NULL),
                     RAYDIFF_ERROR_NONE);
    assert_string_equal(text, "1/3");
    ASSERT_REFUSED(RAYDIFF_ERROR_LIMIT, "3 bytes are too few",
                   raydiff_exact_text(oracle, third, 0, text, 3, &why));
    assert_string_equal(text, "");
    ASSERT_INPUT("triangle 1: there are 1", raydiff_exact_text(oracle, third, 1, text, 9, &why));
    ASSERT_INPUT("does not hit", raydiff_exact_text(oracle, beside, 0, text, 9, &why));
    raydiff_oracle_free(oracle);
}

static void hard_rays_are_those_of_the_set(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("sphere:n=4");
    static float ray[8 * 100];
    for (size_t s = 0; ray_sets[s]; s++) {
        struct ray *wanted;
        assert_int_equal(ray_set_new(ray_sets[s], &stand.scene, 11, 100, &wanted, NULL), STATUS_OK);
        assert_int_equal(raydiff_hard_rays(stand.oracle, ray_sets[s]->name, 11, 100, ray, NULL),
                         RAYDIFF_ERROR_NONE);
        assert_memory_equal(ray, wanted, sizeof ray);
        if (s == 0) {
            assert_int_equal(raydiff_hard_rays(stand.oracle, NULL, 11, 100, ray, NULL), 0);
            assert_memory_equal(ray, wanted, sizeof ray);
        }
        free(wanted);
    }
    ASSERT_INPUT("there is no 'edgs'; did you mean edges?",
                 raydiff_hard_rays(stand.oracle, "edgs", 11, 100, ray, &why));
    assert_true(ray[6] == 0);
    ASSERT_INPUT("rays: is NULL", raydiff_hard_rays(stand.oracle, NULL, 11, 1, NULL, &why));
    library_stand_free(&stand);
}

/* A tree as `raydiff precompute --layout rf16` writes it. */
static char *packed_bytes(const struct scene *scene, size_t *size)
{
    struct bvh bvh;
    struct packed packed;
    const struct build_options build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    char *bytes;
    FILE *stream = open_memstream(&bytes, size);
    assert_int_equal(builder_find("median")->build(scene, &build, &bvh, NULL), STATUS_OK);
    assert_int_equal(packed_make(layout_find("rf16"), &bvh, scene, &packed, NULL), STATUS_OK);
    packed_file_write(&packed, stream);
    assert_int_equal(fclose(stream), 0);
    packed_free(&packed);
    bvh_free(&bvh);
    return bytes;
}

static void packed_trees_are_checked(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("soup:n=60"), other = library_stand("soup:n=61");
    struct raydiff_faults faults;
    size_t size;
    char *bytes = packed_bytes(&stand.scene, &size);
    assert_int_equal(raydiff_check_tree(stand.oracle, bytes, size, &faults, &why), 0);
    assert_string_equal(why.line, "");
    assert_memory_equal(&faults, &(struct raydiff_faults){0}, sizeof faults);
    ASSERT_INPUT("is of 60 triangles",
                 raydiff_check_tree(other.oracle, bytes, size, &faults, &why));
    ASSERT_INPUT("bytes", raydiff_check_tree(stand.oracle, bytes, size - 4, &faults, &why));
    ASSERT_INPUT("does not begin", raydiff_check_tree(stand.oracle, "", 0, &faults, &why));
    ASSERT_INPUT("bytes: is NULL", raydiff_check_tree(stand.oracle, NULL, 0, &faults, &why));
    /* A root that is too small can be traversed, and is not right: words of a record are bounds. */
    uint32_t word = 0;
    const size_t records = size - 4 * 60 - 16 * 4;
    bool seen = false;
    for (size_t at = 48; at + 4 <= records && !seen; at += 16) {
        memcpy(&word, bytes + at, 4);
        memset(bytes + at, 0, 4);
        seen = raydiff_check_tree(stand.oracle, bytes, size, &faults, &why) == 0 &&
               faults.loose_boxes > 0;
        memcpy(bytes + at, &word, 4);
    }
    assert_true(seen);
    assert_string_not_equal(why.line, "");
    free(bytes);
    library_stand_free(&stand);
    library_stand_free(&other);
}

/* Words of a tree, changed: what is found is what packed_file_read finds, number by number. */
static void faults_are_those_of_the_file(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("soup:n=60");
    struct raydiff_faults faults;
    size_t size, kinds[5] = {0};
    char *bytes = packed_bytes(&stand.scene, &size);
    struct rng rng = rng_make(3, 0);
    for (int i = 0; i < 4000; i++) {
        struct packed packed;
        struct packed_faults wanted;
        struct reason reason = {""};
        uint32_t old, word;
        const size_t at = 52 + 4 * (size_t)rng_below(&rng, (uint32_t)(size - 52) / 4);
        memcpy(&old, bytes + at, 4);
        word = i % 2 ? rng_below(&rng, 64) : old ^ 1u << rng_below(&rng, 32);
        memcpy(bytes + at, &word, 4);
        const enum status status =
            packed_file_read("tree", bytes, size, &stand.scene, &packed, &wanted, &reason);
        packed_free(&packed);
        assert_int_equal(raydiff_check_tree(stand.oracle, bytes, size, &faults, &why),
                         status ? RAYDIFF_ERROR_INPUT : RAYDIFF_ERROR_NONE);
        memcpy(bytes + at, &old, 4);
        assert_string_equal(why.line, reason.text);
        if (status)
            wanted = (struct packed_faults){0};
        const struct raydiff_faults same = {
            wanted.loose_boxes,  wanted.bad_refs,  wanted.cycles,   wanted.lost_prims,
            wanted.double_prims, wanted.bad_prims, wanted.too_deep, wanted.bad_tris};
        assert_memory_equal(&faults, &same, sizeof faults);
        kinds[0] += status != STATUS_OK;
        kinds[1] += faults.loose_boxes > 0;
        kinds[2] += faults.lost_triangles > 0;
        kinds[3] += faults.double_triangles > 0;
        kinds[4] += why.line[0] == '\0';
    }
    for (size_t k = 0; k < ARRAY_COUNT(kinds); k++)
        assert_true(kinds[k] > 10);
    free(bytes);
    library_stand_free(&stand);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_version_is_that_of_the_program),
        cmocka_unit_test(numbers_past_the_last_have_no_name),
        cmocka_unit_test(wrong_triangles_are_named),
        cmocka_unit_test(no_triangles_are_hit_by_nothing),
        cmocka_unit_test(triangles_are_copied),
        cmocka_unit_test(exact_answers_are_the_oracles_on_any_threads),
        cmocka_unit_test(all_hits_stand_in_the_order_of_t),
        cmocka_unit_test(a_fraction_is_exact),
        cmocka_unit_test(hard_rays_are_those_of_the_set),
        cmocka_unit_test(packed_trees_are_checked),
        cmocka_unit_test(faults_are_those_of_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
