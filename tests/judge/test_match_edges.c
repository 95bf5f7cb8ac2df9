/* Laws of ref/match/match_edges.c: many losses beside edges are no rounding, a few are; and of
 * --require watertight. */
#include "ref/match/match_edges.h"
#include "ref/match/match_judge.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/honest.h"
#include "tests/support/matched.h"

#include <math.h>
#include <string.h>

#define MANY 1000

static struct judgement at(double margin, bool lost)
{
    return (struct judgement){.margin = margin, .edge_lost = lost};
}

/* `lost` of `hits` rays, all different or all the same, at that margin. */
static size_t beyond(size_t hits, size_t lost, double margin, bool same)
{
    static struct ray ray[MANY];
    static uint8_t note[MANY];
    struct row row = {.rays = hits};
    memset(ray, 0, sizeof ray);
    for (size_t i = 0; i < hits; i++) {
        struct judgement judgement = at(margin, i < lost);
        ray[i].org[0] = same ? 1.0f : (float)i;
        note[i] = match_edges_note(&judgement);
    }
    assert_int_equal(match_edges_count(ray, note, &row), STATUS_OK);
    return row.edges_beyond;
}

static void more_than_rounding_loses_is_beyond(void **state)
{
    (void)state;
    static const double margins[] = {0.02, 0.05, 0.1, 0.9};
    for (size_t class = 0; class < MATCH_EDGES; class ++) {
        size_t limit = (size_t)match_edges_limit(class, MANY);
        assert_int_equal(beyond(MANY, limit, margins[class], false), 0);
        assert_int_equal(beyond(MANY, limit + 1, margins[class], false), 1);
        assert_int_equal(beyond(MANY, MANY, margins[class], false), MANY - limit);
        assert_true(class == 0 || (double)limit < match_edges_limit(class - 1, MANY));
    }
}

/* Shares of 1/2, 1/8, 1/32 and 1/64 of 1000 hits, three standard deviations and 4. */
static void limits_by_value(void **state)
{
    (void)state;
    static const double limits[MATCH_EDGES] = {571.0820, 162.5410, 52.0205, 31.4835};
    for (size_t class = 0; class < MATCH_EDGES; class ++)
        assert_true(fabs(match_edges_limit(class, MANY) - limits[class]) < 1e-3);
    assert_true(match_edges_limit(3, 0) == 4.0);
    struct edges_lost edges[MATCH_EDGES] = {{1000, 573}, {1000, 162}, {1000, 53}, {0, 5}};
    assert_int_equal(match_edges_beyond(edges), 2 + 0 + 1 + 1);
}

/* Twice the rank of each, in another order; of none nothing is changed. */
static void displacements_by_value(void **state)
{
    (void)state;
    static const size_t known[][3] = {{1, 1, 1},     {2, 1, 2},      {3, 2, 3},      {99, 50, 99},
                                      {100, 50, 99}, {101, 51, 100}, {200, 100, 198}};
    double displacement[200];
    for (size_t k = 0; k < ARRAY_COUNT(known); k++) {
        size_t count = known[k][0];
        struct row row = {.displacement.count = count};
        for (size_t i = 0; i < count; i++)
            displacement[i] = 2 * (double)(i * 13 % count + 1); /* 13 divides no count */
        match_displacements(displacement, &row);
        assert_true(row.displacement.p50 == 2 * (double)known[k][1]);
        assert_true(row.displacement.p99 == 2 * (double)known[k][2]);
        assert_true(row.displacement.most == 2 * (double)count);
    }
    struct row none = {.displacement.p50 = 7};
    match_displacements(displacement, &none);
    assert_true(none.displacement.p50 == 7 && none.displacement.most == 0);
}

static void what_any_test_may_lose_is_not_counted(void **state)
{
    (void)state;
    assert_int_equal(beyond(MANY, MANY, 1.0 / 64, false), 0);
    assert_int_equal(beyond(MANY, MANY, 0, false), 0); /* farther inside, or no hit */
}

static void a_ray_counts_once(void **state)
{
    (void)state;
    assert_int_equal(beyond(MANY, MANY, 0.9, true), 0);
}

/* Published tests, alone on each ray's nearest triangle, stay within the shares by far. */
static void published_tests_stay_within(void **state)
{
    (void)state;
    static const char *const specs[] = {"needles:n=400", "sphere:n=16", "soup:n=400", "cornell"};
    const size_t count = getenv("RAYDIFF_SLOW") ? 300000 : 20000;
    struct ray *ray = calloc(count, sizeof *ray);
    struct oracle_answer *truth = calloc(count, sizeof *truth);
    uint8_t *note = calloc(count, 1);
    assert_true(ray && truth && note);
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct scene scene;
        struct oracle *oracle;
        struct judge *judge;
        struct reason reason = {""};
        const struct model unknown = {.formula = TWIN_UNKNOWN};
        if (scene_open(specs[s], 3, &scene, &reason) || oracle_make(&scene, &oracle, &reason) ||
            ray_set_make(ray_set_find("edges"), &scene, 3, count, ray, &reason) ||
            oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, count, 1, truth, NULL,
                           &reason) ||
            judge_make(oracle, &unknown, QUERY_ANY, &judge, &reason))
            fail_msg("%s", reason.text);
        for (size_t t = 0; t < HONEST_PLAIN + (honest_fast_runs() ? HONEST_FAST : 0); t++) {
            const struct honest *test =
                t < HONEST_PLAIN ? &honest_plain[t] : &honest_fast[t - HONEST_PLAIN];
            struct row row = {.rays = count};
            for (size_t i = 0; i < count; i++) {
                struct judgement judgement = {.verdict = VERDICT_RIGHT};
                struct hit hit = {.prim = truth[i].prim};
                float v[3][3];
                note[i] = 0;
                if (hit.prim == ABI_NO_PRIM || !ray_in_contract(&ray[i]))
                    continue;
                scene_tri(&scene, hit.prim, v);
                if (!test->hits(&ray[i], (const float(*)[3])v, &hit))
                    hit = (struct hit){.prim = ABI_NO_PRIM};
                assert_int_equal(judge_answer(judge, &ray[i], &truth[i], &hit, &judgement),
                                 STATUS_OK);
                note[i] = match_edges_note(&judgement);
            }
            assert_int_equal(match_edges_count(ray, note, &row), STATUS_OK);
            print_message("%-14s %-22s", specs[s], test->name);
            for (size_t c = 0; c < MATCH_EDGES; c++)
                print_message("  %zu of %zu", row.edges[c].lost, row.edges[c].hits);
            print_message("\n");
            assert_int_equal(row.edges_beyond, 0);
            for (size_t c = 0; c < MATCH_EDGES; c++) /* half of what may be, and room by chance */
                assert_true((double)row.edges[c].lost <=
                            0.5 * match_edges_limit(c, row.edges[c].hits) + 4);
        }
        judge_free(judge);
        oracle_free(oracle);
        scene_free(&scene);
    }
    free(note);
    free(truth);
    free(ray);
}

static void whoever_must_be_watertight_fails_if_a_fan_is_lost(void **state)
{
    (void)state;
    for (int must = 0; must < 2; must++) {
        struct fixture *f = prepare("sphere:n=8", "median", 4);
        assert_int_equal(ray_set_make(ray_set_find("edges"), &f->scene, 3, RAYS, f->ray, NULL),
                         STATUS_OK);
        f->options.demands.watertight = must;
        f->options.tri = tri_test_find("mt");
        start(f);
        pack(f, "f32");
        run(f, "cpu");
        assert_int_equal(f->row.status, ROW_OK);
        assert_int_equal(f->row.count[VERDICT_WRONG], 0);
        assert_true(must ? f->row.fans_lost > 0 && row_failed(&f->row) : !row_failed(&f->row));
        match_free(&f->match);
        f->options.tri = tri_test_find("woop");
        f->options.box = box_test_find("watertight");
        start(f);
        pack(f, "f32");
        run(f, "cpu");
        assert_int_equal(f->row.fans_lost, 0);
        assert_false(row_failed(&f->row));
        done(f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(more_than_rounding_loses_is_beyond),
        cmocka_unit_test(limits_by_value),
        cmocka_unit_test(displacements_by_value),
        cmocka_unit_test(what_any_test_may_lose_is_not_counted),
        cmocka_unit_test(a_ray_counts_once),
        cmocka_unit_test(published_tests_stay_within),
        cmocka_unit_test(whoever_must_be_watertight_fails_if_a_fan_is_lost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
