/* Modes of a library beside its plain engine: whose bits differ, and which is right. The engines
 * are brute force whose answers are changed. */
#include "ref/match/match.h"
#include "ref/trace/trace.h"
#include "scenes/scenes.h"

#include <math.h>
#include <string.h>

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#define RAYS 18000 /* more than are judged in one go */

static struct ray ray[RAYS];
static struct scene scene;
static struct hit own[RAYS]; /* of brute force */

/* Rays that hit, by what becomes of them: i % 12. */
enum what_becomes {
    NOTHING,
    MODE_LOSES,
    PLAIN_LOSES,
    BOTH_LOSE,
    MODE_ROUNDS,
    MODE_LOSES_TWO,
    ALL = 12
};

static bool loses(size_t i, bool mode)
{
    const size_t what = i % ALL;
    return what == BOTH_LOSE ||
           (mode ? what == MODE_LOSES || what == MODE_LOSES_TWO : what == PLAIN_LOSES);
}

static enum status trace(bool mode, void *self, const struct ray *rays, size_t count,
                         struct hit *hit, struct trace_report *report, struct reason *reason)
{
    enum status status = engine_reference(false)->trace(self, rays, count, hit, report, reason);
    for (size_t i = 0; i < count && !status; i++) {
        if (hit[i].prim == ABI_NO_PRIM)
            continue;
        if (loses(i, mode))
            hit[i] = (struct hit){.t = mode ? 0 : 1, .prim = ABI_NO_PRIM};
        else if (mode && i % ALL == MODE_ROUNDS)
            hit[i].t = nextafterf(hit[i].t, 0);
    }
    return status;
}

static enum status trace_mode(void *self, const struct ray *rays, size_t count, struct hit *hit,
                              struct trace_report *report, struct reason *reason)
{
    return trace(true, self, rays, count, hit, report, reason);
}

static enum status trace_plain(void *self, const struct ray *rays, size_t count, struct hit *hit,
                               struct trace_report *report, struct reason *reason)
{
    return trace(false, self, rays, count, hit, report, reason);
}

/* At the middle of a triangle, from beyond the scene: what is lost there no rule allows. */
static struct ray at_middle(uint32_t i)
{
    struct ray out = {.tmax = 1e30f};
    float v[3][3];
    scene_tri(&scene, i % scene.tri_count, v);
    for (int k = 0; k < 3; k++) {
        out.org[k] = k == (int)(i % 3) ? 9.0f : -3.0f - (float)(i % 31);
        out.dir[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 - out.org[k];
    }
    return out;
}

static void it_is_counted_who_is_right(void **state)
{
    (void)state;
    struct reason reason = {""};
    struct pool pool = {.options = {.threads = 1, .device = -1}};
    struct engine plain = *engine_reference(false), mode = plain;
    struct match_options options = {.builder = builders[0],
                                    .build = {.leaf = 2, .eps = BUILD_EPS_DEFAULT},
                                    .box = box_tests[0],
                                    .tri = tri_tests[0],
                                    .query = QUERY_CLOSEST,
                                    .brute_budget = UINT64_MAX,
                                    .repeats = 1};
    struct match match;
    struct row row;
    size_t of[ALL] = {0}, hits = 0;
    plain.name = "plain", plain.trace = trace_plain, plain.reference = plain.brute = false;
    mode = plain;
    mode.name = "mode", mode.trace = trace_mode, mode.plain = &plain;
    if (scene_open("soup:n=60,size=0.5", 1, &scene, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < RAYS; i++)
        ray[i] = at_middle(i);
    if (match_make(&scene, ray, RAYS, &options, &pool, &match, &reason))
        fail_msg("%s", reason.text);
    match_run(&match, engine_reference(false), &row);
    assert_int_equal(row.status, ROW_OK);
    memcpy(own, match.answer, sizeof own);
    for (size_t i = 0; i < RAYS; i++)
        if (own[i].prim != ABI_NO_PRIM) {
            of[i % ALL]++;
            hits++;
        }
    assert_true(hits > RAYS / 4);
    match_run(&match, &mode, &row);
    assert_int_equal(row.status, ROW_OK);
    assert_ptr_equal(row.against, &plain);
    assert_false(row.bits);
    assert_int_equal(row.bit_differences, 0);
    assert_int_equal(row.moved, of[MODE_LOSES] + of[MODE_LOSES_TWO] + of[PLAIN_LOSES] +
                                    of[BOTH_LOSE] + of[MODE_ROUNDS]);
    assert_int_equal(row.beside.both, of[MODE_ROUNDS]);
    assert_int_equal(row.beside.own, of[PLAIN_LOSES]);
    assert_int_equal(row.beside.plain, of[MODE_LOSES] + of[MODE_LOSES_TWO]);
    assert_int_equal(row.beside.neither, of[BOTH_LOSE]);
    assert_true(row_counts_bits(&row));
    match_free(&match);
    pool_free(&pool);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(it_is_counted_who_is_right)};
    return cmocka_run_group_tests_name("modes_beside", tests, NULL, NULL);
}
