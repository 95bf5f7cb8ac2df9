/* Dishonest tracers (tests/adversaries): each does no more harm than is stated, or is caught.
 * RAYDIFF_ADVERSARIES=MESH plays them on that mesh, with many rays, and prints the table of
 * `make adversaries`. */
#include "ref/match/match.h"
#include "ref/base/rng.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/adversaries/cheats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the engine ------------------------------------------------------------------------------ */

static struct {
    const struct cheat *cheat;
    const struct match *match;
    struct judge *judge;        /* that the cheat asks */
    size_t calls, spoilt, hits; /* of the first call */
} now;

static enum status open_cpu(const struct engine *engine, const struct engine_options *options,
                            void **self, struct reason *reason)
{
    (void)engine;
    return engine_open(engine_find("cpu"), options, self, reason);
}

static enum status prepare_cpu(void *self, const struct job *job, struct reason *reason)
{
    return engine_find("cpu")->prepare(self, job, reason);
}

static enum status trace_and_spoil(void *self, const struct ray *ray, size_t ray_count,
                                   struct hit *hit, struct trace_report *report,
                                   struct reason *reason)
{
    enum status status = engine_find("cpu")->trace(self, ray, ray_count, hit, report, reason);
    struct hit *right = malloc((ray_count + 1) * sizeof *right);
    assert_non_null(right);
    memcpy(right, hit, ray_count * sizeof *right);
    now.calls++;
    struct lie lie = {now.match, now.calls, ray_count, ray, right, now.judge, now.cheat->amount};
    for (size_t i = 0; i < ray_count && !status; i++) {
        now.cheat->spoil(&lie, i, &hit[i]);
        if (now.calls > 1)
            continue;
        now.hits += right[i].prim != ABI_NO_PRIM;
        now.spoilt += memcmp(&right[i], &hit[i], sizeof *hit) != 0;
    }
    free(right);
    return status;
}

static enum status trace_all_and_spoil(void *self, const struct ray *ray, size_t ray_count,
                                       uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                       struct reason *reason)
{
    enum status status =
        engine_find("cpu")->trace_all(self, ray, ray_count, capacity, hit, hit_count, reason);
    struct lie lie = {now.match, ++now.calls, ray_count, ray, NULL, now.judge, now.cheat->amount};
    for (size_t i = 0; i < ray_count && !status; i++) {
        uint32_t before = hit_count[i];
        now.cheat->spoil_list(&lie, i, hit + i * capacity, &hit_count[i], capacity);
        now.hits += before > 0;
        now.spoilt += hit_count[i] != before;
    }
    return status;
}

static struct model model_of(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return now.cheat->model;
}

static void close_cpu(void *self)
{
    engine_find("cpu")->close(self);
}

static const struct engine liar = {.name = "liar",
                                   .summary = "spoils what cpu answers",
                                   .needs_packed = true,
                                   .open = open_cpu,
                                   .prepare = prepare_cpu,
                                   .trace = trace_and_spoil,
                                   .trace_all = trace_all_and_spoil,
                                   .model = model_of,
                                   .close = close_cpu};

/* --- rays ------------------------------------------------------------------------------------ */

/* A square picture of the whole scene from so many sizes away. */
static void from_afar(const struct scene *scene, double sizes, size_t count, struct ray *ray)
{
    struct box box = scene_bounds(scene);
    double middle[3], size = 0, to[3] = {0.3, 0.2, 0.93}, right[3] = {0.93, 0, -0.3}, up[3];
    size_t side = (size_t)sqrt((double)count);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * ((double)box.lo[k] + (double)box.hi[k]);
        size = fmax(size, (double)box.hi[k] - (double)box.lo[k]);
    }
    for (int k = 0; k < 3; k++)
        up[k] = to[(k + 1) % 3] * right[(k + 2) % 3] - to[(k + 2) % 3] * right[(k + 1) % 3];
    for (size_t i = 0; i < count; i++) {
        double x = ((double)(i % side) + 0.5) / (double)side - 0.5;
        double y = ((double)(i / side % side) + 0.5) / (double)side - 0.5;
        ray[i] = (struct ray){.tmax = RAY_TMAX};
        for (int k = 0; k < 3; k++) {
            double from = middle[k] + sizes * size * to[k];
            double at = middle[k] + size * (x * right[k] + y * up[k]);
            ray[i].org[k] = (float)from;
            ray[i].dir[k] = (float)((at - from) / (sizes * size));
        }
    }
}

/* In the plane of a flat scene, and through it. */
static void in_plane(const struct scene *scene, size_t count, struct ray *ray)
{
    struct box box = scene_bounds(scene);
    struct rng rng = rng_make(3, 0);
    int flat = 0;
    for (int k = 1; k < 3; k++)
        if (box.hi[k] - box.lo[k] < box.hi[flat] - box.lo[flat])
            flat = k;
    for (size_t i = 0; i < count; i++) {
        ray[i] = (struct ray){.tmax = RAY_TMAX};
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = box.lo[k] - 1.0f - rng_float(&rng);
            ray[i].dir[k] = rng_range(&rng, box.lo[k], box.hi[k]) - ray[i].org[k];
        }
        if (i % 2 == 0) {
            ray[i].org[flat] = box.lo[flat];
            ray[i].dir[flat] = 0;
        }
    }
}

static void make_rays(const struct cheat *cheat, const struct scene *scene, size_t count,
                      struct ray *ray)
{
    static const char *const sets[] = {"primary", "mixed", "ranges", "axis", NULL, NULL, "mixed"};
    struct reason reason = {""};
    if (cheat->rays == RAYS_FAR)
        from_afar(scene, cheat->amount, count, ray);
    else if (cheat->rays == RAYS_IN_PLANE)
        in_plane(scene, count, ray);
    else if (ray_set_make(ray_set_find(sets[cheat->rays]), scene, 5, count, ray, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; cheat->rays == RAYS_BAD && i < count; i += 2)
        ray[i].dir[i / 2 % 3] = i % 4 ? NAN : INFINITY;
}

/* --- play ------------------------------------------------------------------------------------ */

/* The scene with one triangle more, of three equal vertices. */
static void add_degenerate(struct scene *scene)
{
    struct scene more;
    assert_int_equal(scene_make(scene->vertex_count, scene->tri_count + 1, &more), STATUS_OK);
    memcpy(more.vertex, scene->vertex, 3 * (size_t)scene->vertex_count * sizeof *more.vertex);
    memcpy(more.index, scene->index, 3 * (size_t)scene->tri_count * sizeof *more.index);
    for (int c = 0; c < 3; c++)
        more.index[3 * (size_t)scene->tri_count + (size_t)c] = 0;
    scene_free(scene);
    *scene = more;
}

/* The scene with so many triangles more that are lines: the first side of another, there and back.
 */
static void add_lines(struct scene *scene, uint32_t count)
{
    struct scene more;
    count = scene->tri_count < count ? scene->tri_count : count;
    assert_int_equal(scene_make(scene->vertex_count, scene->tri_count + count, &more), STATUS_OK);
    memcpy(more.vertex, scene->vertex, 3 * (size_t)scene->vertex_count * sizeof *more.vertex);
    memcpy(more.index, scene->index, 3 * (size_t)scene->tri_count * sizeof *more.index);
    for (uint32_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++)
            more.index[3 * (size_t)(scene->tri_count + i) + c] =
                scene->index[3 * (size_t)(i * (scene->tri_count / count)) + (c ? 1 : 0)];
    scene_free(scene);
    *scene = more;
}

/* cpu runs what the cheat says that it does, where C has it; but for those whose cheat that is. */
static const struct tri_test *test_of(const struct cheat *cheat)
{
    if (cheat >= outsiders && cheat < outsiders + outsider_count)
        for (size_t i = 0; tri_tests[i]; i++)
            if (twin_of_tri(tri_tests[i]->id) == cheat->model.formula)
                return tri_tests[i];
    return tri_test_find("mt");
}

static void play(const struct cheat *cheat, const char *spec, size_t count, struct row *row)
{
    struct scene scene;
    struct match match;
    struct pool pool = {.options = {.device = -1}};
    struct reason reason = {""};
    struct ray *ray = calloc(count, sizeof *ray);
    assert_non_null(ray);
    if (scene_open(cheat->scene ? cheat->scene : spec, 3, &scene, &reason))
        fail_msg("%s", reason.text);
    if (strstr(cheat->name, "without area"))
        add_degenerate(&scene);
    if (strstr(cheat->name, "that are lines"))
        add_lines(&scene, CHEAT_LINES);
    make_rays(cheat, &scene, count, ray);
    const struct match_options options = {.builder = builder_find("median"),
                                          .build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT},
                                          .box = box_tests[0],
                                          .tri = test_of(cheat),
                                          .query = cheat->query,
                                          .repeats = 1};
    if (match_make(&scene, ray, count, &options, &pool, &match, &reason) ||
        match_pack(&match, layout_find("f32"), &reason))
        fail_msg("%s: %s", cheat->name, reason.text);
    memset(&now, 0, sizeof now);
    now.cheat = cheat;
    now.match = &match;
    if (judge_make(match.oracle, &cheat->model, cheat->query, &now.judge, &reason))
        fail_msg("%s", reason.text);
    match_run(&match, &liar, row);
    judge_free(now.judge);
    match_free(&match);
    pool_free(&pool);
    scene_free(&scene);
    free(ray);
}

/* Plays one, and says whether it did what is stated. */
static bool is_as_stated(const struct cheat *cheat, const char *large, size_t quick, bool *caught)
{
    struct row row;
    play(cheat, large ? large : "sphere:n=24",
         large ? (cheat->scene || cheat->spoil_list ? 20000 : 30 * quick) : quick, &row);
    double share = (double)now.spoilt / (double)(now.hits ? now.hits : 1);
    bool failed = row_failed(&row), played = row.status == ROW_OK || row.status == ROW_VACUOUS;
    *caught = failed;
    if (large)
        print_message("%-48s %-18s %9.4f%% %9zu %9.3g  %s\n", cheat->name, cheat->uses, 100 * share,
                      row.count[VERDICT_WRONG], row.displacement.most,
                      failed ? "caught" : "gets away");
    if (played && (cheat->caught ? failed && (now.spoilt > 0 || now.calls > 1)
                                 : !failed && share <= cheat->away))
        return true;
    print_message("%s: %s%s, %s with %.4f %% of the hits (%zu of %zu), %zu WRONG\n", cheat->name,
                  row_status_name(row.status), row.reason.text, failed ? "caught" : "gets away",
                  100 * share, now.spoilt, now.hits, row.count[VERDICT_WRONG]);
    return false;
}

static void each_is_as_stated(bool lists)
{
    const char *large = getenv("RAYDIFF_ADVERSARIES");
    size_t bad = 0, caught = 0, played = 0, count = cheat_count + outsider_count;
    if (large)
        print_message("%-48s %-18s %10s %9s %9s  %s\n", "adversary", "uses up", "of hits", "WRONG",
                      "max uM", "");
    for (size_t i = 0; i < count; i++) {
        bool ours = i < cheat_count, failed = false;
        const struct cheat *cheat = ours ? &cheats[i] : &outsiders[i - cheat_count];
        if ((cheat->large && !large) || (cheat->query == QUERY_ALL) != lists)
            continue;
        played++;
        bad += !is_as_stated(cheat, large, ours ? 10000 : 2000, &failed);
        caught += failed;
    }
    print_message("%zu adversaries%s, %zu caught\n", played, lists ? " that list all hits" : "",
                  caught);
    assert_int_equal(bad, 0);
}

static void no_tracer_gets_away_with_more_than_is_stated(void **state)
{
    (void)state;
    each_is_as_stated(false);
}

static void no_lists_get_away_with_more_than_is_stated(void **state)
{
    (void)state;
    each_is_as_stated(true);
}

/* The share that the liars of drops_by_class spoil is what rows allow, and no row is vacuous. */
static void honest_rows_lose_nothing(void **state)
{
    (void)state;
    struct cheat honest = cheats[0];
    struct row row;
    honest.amount = -1;
    play(&honest, "sphere:n=24", 20000, &row);
    assert_int_equal(row.status, ROW_OK);
    assert_int_equal(row.differences, 0);
    assert_int_equal(now.spoilt, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(honest_rows_lose_nothing),
        cmocka_unit_test(no_tracer_gets_away_with_more_than_is_stated),
        cmocka_unit_test(no_lists_get_away_with_more_than_is_stated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
