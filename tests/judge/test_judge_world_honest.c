/* No honest answer to a ray of a world is WRONG: each formula of ours, each rounding, closest, any
 * and all hits, behind transforms of many kinds. Some 40,000 answers; RAYDIFF_SLOW=1: over 10^6.
 * And of tracers with transforms of their own, judged as unknown formulas. */
#include "ref/primitives/test_run.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/object_ray.h"
#include "tests/judge/honest_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/support/stand.h"

#define OWN       5 /* of formulas */
#define ROUNDINGS 4
#define RAYS      10

static uint64_t worlds(void)
{
    return getenv("RAYDIFF_SLOW") ? 1700 : 60;
}

static uint64_t verdicts[VERDICT_COUNT], ill;

struct honest_seat {
    const struct judged_world *w;
    struct judge *judge[3]; /* of each query */
    size_t f, r;
    struct legal legal;
};

static struct model model_of(size_t f, size_t r, bool unknown)
{
    if (unknown)
        return (struct model){.formula = TWIN_UNKNOWN, .rounding = roundings[r].rounding};
    return (struct model){.formula = formulas[f].formula,
                          .rounding = roundings[r].rounding,
                          .bits = r == 0,
                          .watertight = formulas[f].formula == TWIN_WOOP && r < 3,
                          .open = formulas[f].formula == TWIN_MT_RTRS};
}

static void not_wrong(const struct honest_seat *s, const struct ray *ray, struct ray_mode mode,
                      const struct judgement *j, const struct hit *hit, const char *query)
{
    verdicts[j->verdict]++;
    ill += j->ill_conditioned;
    if (j->verdict != VERDICT_WRONG)
        return;
    char line[400];
    judge_line(ray, j, hit, line, sizeof line);
    fail_msg("%s, %s, %s, mask %x flags %x: %s: %s", formulas[s->f].name, roundings[s->r].name,
             query, (unsigned)mode.mask, (unsigned)mode.flags, wrong_name(j->wrong), line);
}

static void ask(struct honest_seat *s, const struct ray *ray, struct ray_mode mode)
{
    struct oracle_answer truth = judged_world_truth(s->w, ray, mode);
    enum twin_formula formula = formulas[s->f].formula;
    struct judgement closest, any, out;
    struct hit hit[2], list[WORLD_MOST_HITS];
    uint32_t tag[2], tags[WORLD_MOST_HITS];
    for (int q = 0; q < 2; q++) {
        honest_world_trace(s->w, formula, &s->legal, ray, mode, q ? QUERY_ANY : QUERY_CLOSEST,
                           &hit[q], &tag[q]);
        assert_int_equal(judge_world_answer(s->judge[q], ray, mode, &truth, &hit[q], tag[q], &out),
                         STATUS_OK);
        not_wrong(s, ray, mode, &out, &hit[q], q ? "any" : "closest");
        *(q ? &any : &closest) = out;
    }
    judge_any_against_closest(s->judge[1], ray, &hit[0], &closest, &hit[1], &any);
    not_wrong(s, ray, mode, &any, &hit[1], "any against closest");
    struct list_judgement listed;
    size_t count = honest_world_list(s->w, formula, &s->legal, ray, mode, list, tags);
    assert_int_equal(judge_world_list(s->judge[2], ray, mode, list, tags, count, &listed),
                     STATUS_OK);
    not_wrong(s, ray, mode, &listed.judgement, &listed.at_fault, "all");
}

static void sit(struct honest_seat *s, const struct judged_world *w, size_t f, size_t r,
                bool unknown)
{
    const enum query queries[3] = {QUERY_CLOSEST, QUERY_ANY, QUERY_ALL};
    struct model model = model_of(f, r, unknown);
    struct reason reason = {""};
    *s = (struct honest_seat){.w = w, .f = f, .r = r};
    s->legal = (struct legal){.rounding = model.rounding, .style = LEGAL_ALIKE};
    for (int q = 0; q < 3; q++)
        assert_int_equal(judge_make(w->oracle, &model, queries[q], &s->judge[q], &reason),
                         STATUS_OK);
}

/* Woop's edge functions may have any sign where a triangle is smaller than the rounding of its
 * distance: true if no mesh, of unit size, is nearly so. */
static bool is_near(const struct judged_world *w, const struct ray *ray)
{
    bool near = true;
    for (uint32_t i = 0; i < w->world.instance_count; i++) {
        struct twin_ray placed;
        if (w->world.instance[i].mesh == WORLD_NO_MESH)
            continue;
        twin_ray_of(&w->place[i], ROUNDING_IEEE, false, ray, &placed);
        for (int k = 0; k < 3; k++)
            near = near && fabs(placed.org_near[k]) < 0x1p18;
    }
    return near;
}

/* All rays of one world. */
static void ask_all(const struct judged_world *w, uint64_t i, size_t f, size_t r, bool unknown)
{
    struct honest_seat s;
    struct rng rng = rng_make(i, 11);
    sit(&s, w, f, r, unknown);
    for (int n = 0; n < RAYS; n++) {
        struct ray ray = judged_world_aim(w, &rng);
        struct ray_mode mode = judged_world_mode(&rng);
        s.legal.seed = i * RAYS + (uint64_t)n;
        if (!unknown || is_near(w, &ray))
            ask(&s, &ray, mode);
    }
    for (int q = 0; q < 3; q++)
        judge_free(s.judge[q]);
}

static uint64_t print_verdicts(void)
{
    uint64_t all = 0;
    for (int v = 0; v < VERDICT_COUNT; v++) {
        print_message("%s %llu  ", verdict_name((enum verdict)v), (unsigned long long)verdicts[v]);
        all += verdicts[v];
    }
    print_message("of %llu\n", (unsigned long long)all);
    return all;
}

static void honest_answers_are_never_wrong(void **state)
{
    (void)state;
    memset(verdicts, 0, sizeof verdicts);
    for (uint64_t i = 0; i < worlds(); i++) {
        struct judged_world w;
        judged_world_make(i, &w);
        for (size_t f = 0; f < OWN; f++)
            for (size_t r = 0; r < ROUNDINGS; r++)
                ask_all(&w, i, f, r, false);
        judged_world_free(&w);
    }
    uint64_t all = print_verdicts();
    assert_true(verdicts[VERDICT_RIGHT] > all / 2);
    assert_true(verdicts[VERDICT_BOUNDARY] > 0 && verdicts[VERDICT_TIE] > 0);
    assert_true(verdicts[VERDICT_OUT_OF_CONTRACT] < all / 8);
}

/* In C's arithmetic and in Vulkan's: Moeller and Trumbore, woop, and Pluecker's. */
static void nor_are_those_of_a_black_box(void **state)
{
    (void)state;
    static const size_t told[] = {0, 2, 3};
    memset(verdicts, 0, sizeof verdicts);
    ill = 0;
    for (uint64_t i = 0; i < 2 * worlds(); i++) {
        struct judged_world w;
        judged_world_make(i, &w);
        for (size_t f = 0; f < ARRAY_COUNT(told); f++)
            for (size_t r = 0; r < ROUNDINGS; r += 3) {
                w.affine = i % 2;
                ask_all(&w, i, told[f], r, true);
            }
        judged_world_free(&w);
    }
    uint64_t all = print_verdicts();
    print_message("ill-conditioned %llu\n", (unsigned long long)ill);
    assert_true(verdicts[VERDICT_RIGHT] > all / 3);
    assert_true(ill > 0 && ill < all / 3);
}

/* A sliver of width `width` in units of the displacement that is allowed, 32 u times the distance
 * of its farthest vertex, in a world of its own; the ray meets it at a right angle, through the
 * middle. Returns what a tracer is found to do that says the other side. */
static enum wrong of_the_other_side(double width, bool turned, uint32_t flags)
{
    const float far = 8;
    float vertex[9] = {-far, 0, 3, far, 0, 3, 0, (float)(width * 32 * 0x1p-24 * (double)far), 3};
    uint32_t index[3] = {0, 1, 2};
    const struct scene scene = {
        .vertex = vertex, .vertex_count = 3, .index = index, .tri_count = 1};
    const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    const struct ray_mode mode = {.mask = 0xFF, .flags = flags};
    const struct ray ray = {.org = {0, vertex[7] / 4, 0}, .dir = {0, 0, 1}, .tmax = 100};
    struct world world;
    struct oracle *oracle;
    struct judge *judge;
    struct oracle_answer truth;
    struct judgement j;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    if (turned)
        world.instance[0].flags = ABI_INSTANCE_FLIP_FACING;
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    assert_int_equal(oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, &ray, &mode, 1, 1,
                                          &truth, NULL, NULL),
                     STATUS_OK);
    /* Vertices run counterclockwise along d, so that the back is seen. */
    const struct hit hit = {.t = 3, .u = 0.375f, .v = 0.25f, .prim = 0};
    assert_int_equal(
        judge_world_answer(judge, &ray, mode, &truth, &hit, turned ? 0 : ABI_TAG_FRONT, &j),
        STATUS_OK);
    judge_free(judge);
    oracle_free(oracle);
    world_free(&world);
    return j.wrong;
}

/* Its height shrinks by twice what each vertex moves. */
static void a_side_is_known_where_no_displacement_turns_it(void **state)
{
    (void)state;
    static const double open[] = {0.1, 0.5, 1, 1.9}, known[] = {2.2, 4, 100, 1e5};
    for (int turned = 0; turned < 2; turned++) {
        for (size_t i = 0; i < ARRAY_COUNT(open); i++) {
            assert_int_equal(of_the_other_side(open[i], turned, 0), WRONG_NOT);
            assert_int_equal(
                of_the_other_side(open[i], turned, turned ? ABI_RAY_CULL_FRONT : ABI_RAY_CULL_BACK),
                WRONG_NOT);
        }
        for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
            assert_int_equal(of_the_other_side(known[i], turned, 0), WRONG_FACING);
            assert_int_equal(of_the_other_side(known[i], turned,
                                               turned ? ABI_RAY_CULL_FRONT : ABI_RAY_CULL_BACK),
                             WRONG_CULLED);
        }
    }
}

/* A sheared and stretched instance of a sliver, and a ray that meets it flatly, as the mesh sees
 * it. */
static void flat_case(struct rng *rng, float m[3][4], float vertex[9], struct ray *ray)
{
    double e[2][3], aim[3], d[3];
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 3; j++)
            m[k][j] = rng_range(rng, -1, 1) * ldexpf(1, (int)rng_below(rng, 9));
        m[k][3] = rng_range(rng, -4, 4);
        vertex[k] = rng_range(rng, -1, 1);
        e[0][k] = (double)rng_range(rng, -1, 1);
        e[1][k] =
            e[0][k] * 0.6 + (double)rng_range(rng, -1, 1) * ldexp(1, -(int)rng_below(rng, 16));
        vertex[3 + k] = (float)((double)vertex[k] + e[0][k]);
        vertex[6 + k] = (float)((double)vertex[k] + e[1][k]);
    }
    const double u = 0.1 + 0.4 * (double)rng_float(rng), v = 0.1 + 0.4 * (double)rng_float(rng);
    const double lift = ldexp(1, -(int)rng_below(rng, 14));
    const double along[2] = {(double)rng_range(rng, -1, 1), (double)rng_range(rng, -1, 1)};
    for (int k = 0; k < 3; k++) {
        aim[k] = (double)vertex[k] + u * e[0][k] + v * e[1][k];
        d[k] = along[0] * e[0][k] + along[1] * e[1][k] + lift * (double)rng_range(rng, -1, 1);
    }
    *ray = (struct ray){.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        double at = (double)m[k][3], to = 0;
        for (int j = 0; j < 3; j++) {
            at += (double)m[k][j] * aim[j];
            to += (double)m[k][j] * d[j];
        }
        ray->dir[k] = (float)to;
        ray->org[k] = (float)(at - 3 * to);
    }
}

/* What a tracer with one triangle answers that takes the ray into the mesh, and how it is judged.
 * */
static enum wrong of_flat_case(uint64_t seed, const char *tri, bool *judged)
{
    struct rng rng = rng_make(seed, 77);
    float vertex[9];
    uint32_t index[3] = {0, 1, 2};
    const struct scene scene = {
        .vertex = vertex, .vertex_count = 3, .index = index, .tri_count = 1};
    const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    const struct ray_mode mode = ray_mode_all();
    struct world world;
    struct instance_record *record;
    struct oracle *oracle;
    struct judge *judge;
    struct oracle_answer truth;
    struct judgement j = {.wrong = WRONG_NOT};
    struct ray ray;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    flat_case(&rng, world.instance[0].m, vertex, &ray);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    assert_int_equal(world_records_make(&world, &record, NULL), STATUS_OK);
    assert_int_equal(oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, &ray, &mode, 1, 1,
                                          &truth, NULL, NULL),
                     STATUS_OK);
    struct ray placed = transform_ray(record, &ray);
    struct tri_ray r = tri_ray_make(&placed);
    struct hit hit;
    float v[3][3];
    uint32_t tag = 0;
    scene_tri(&scene, 0, v);
    if (tri_test_run(tri_test_find(tri)->id, &r, v, &hit)) {
        hit.prim = 0;
        double n[3], side = 0;
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            n[k] = ((double)v[1][a] - (double)v[0][a]) * ((double)v[2][b] - (double)v[0][b]) -
                   ((double)v[1][b] - (double)v[0][b]) * ((double)v[2][a] - (double)v[0][a]);
            side += n[k] * (double)placed.dir[k];
        }
        tag = side < 0 ? ABI_TAG_FRONT : 0;
    } else {
        hit = hit_none();
    }
    assert_int_equal(judge_world_answer(judge, &ray, mode, &truth, &hit, tag, &j), STATUS_OK);
    *judged = j.verdict != VERDICT_OUT_OF_CONTRACT;
    free(record);
    judge_free(judge);
    oracle_free(oracle);
    world_free(&world);
    return j.wrong;
}

/* The test cancels in the space of the mesh, where other products do than in the world. */
static void slivers_of_sheared_instances_are_judged_as_their_meshes_see_them(void **state)
{
    (void)state;
    static const char *const tests[] = {"mt", "woop", "pluecker"};
    const uint64_t count = getenv("RAYDIFF_SLOW") ? 1000000 : 20000;
    uint64_t judged = 0, wrong = 0;
    for (uint64_t i = 0; i < count; i++)
        for (size_t t = 0; t < ARRAY_COUNT(tests); t++) {
            bool one;
            enum wrong kind = of_flat_case(i, tests[t], &one);
            judged += one;
            wrong += kind != WRONG_NOT;
            if (kind != WRONG_NOT && wrong < 10)
                print_message("case %llu, %s: %s\n", (unsigned long long)i, tests[t],
                              wrong_name(kind));
        }
    print_message("%llu of %llu judged answers are WRONG\n", (unsigned long long)wrong,
                  (unsigned long long)judged);
    assert_true(judged > count * 2);
    assert_int_equal(wrong, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(honest_answers_are_never_wrong),
        cmocka_unit_test(nor_are_those_of_a_black_box),
        cmocka_unit_test(slivers_of_sheared_instances_are_judged_as_their_meshes_see_them),
        cmocka_unit_test(a_side_is_known_where_no_displacement_turns_it),
    };
    return cmocka_run_group_tests_name("judge_world_honest", tests, NULL, NULL) ? 1 : 0;
}
