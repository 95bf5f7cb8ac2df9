/* Published tests as black boxes: whatever they answer is allowed, and what no test can answer is
 * not. RAYDIFF_SLOW: 10^6 answers of each. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/honest.h"
#include "tests/judge/honest_count.h"
#include "tests/judge/judge_fixture.h"

#include <math.h>

static const struct fixture_subject *const unknown = &subjects[SUBJECTS - 1];

static struct hit nearest(const struct honest *test, const struct scene *scene,
                          const struct ray *ray)
{
    struct hit best = {.prim = ABI_NO_PRIM}, hit;
    for (uint32_t prim = 0; prim < scene->tri_count; prim++) {
        float v[3][3];
        scene_tri(scene, prim, v);
        if (!test->hits(ray, (const float(*)[3])v, &hit) ||
            (best.prim != ABI_NO_PRIM && !(hit.t < best.t)))
            continue;
        best = hit;
        best.prim = prim;
    }
    return best;
}

static const char *const specs[] = {"soup:n=60", "sphere:n=2",   "grid:n=5,height=0",
                                    "cornell",   "needles:n=60", "stack:n=12",
                                    "platonic",  "terrain:k=2"};

static const struct honest *honest_at(size_t i)
{
    return i < HONEST_PLAIN ? &honest_plain[i] : &honest_fast[i - HONEST_PLAIN];
}

static void show(const struct judge_fixture *c, const struct hit *hit, const char *test,
                 const char *spec)
{
    char line[400];
    judge_line(&c->ray, &c->judgement, hit, line, sizeof line);
    print_message("%s, %s: WRONG (%s): %s\n", test, spec, wrong_name(c->judgement.wrong), line);
}

/* All ray sets by turns, aimed at edges and vertices, in planes, at ends of ranges. */
static void published_tests_are_never_wrong(void **state)
{
    (void)state;
    const size_t each = getenv("RAYDIFF_SLOW") ? 160000 : 4000;
    struct ray *ray = calloc(each, sizeof *ray);
    assert_non_null(ray);
    uint64_t refused = 0;
    size_t tests = HONEST_PLAIN + (honest_fast_runs() ? HONEST_FAST : 0);
    for (size_t i = 0; i < tests; i++) {
        const struct honest *test = honest_at(i);
        double most = 0, share = 0;
        struct honest_count honest = honest_begun();
        size_t answers = 0, count[VERDICT_COUNT] = {0};
        for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
            struct judge_fixture *c = judge_fixture_open(specs[s], 7);
            judge_fixture_seat(c, unknown, QUERY_CLOSEST);
            assert_int_equal(ray_set_make(ray_sets[0], &c->scene, 8 + s, each, ray, NULL),
                             STATUS_OK);
            for (size_t k = 0; k < each; k++) {
                if (!ray_in_contract(&ray[k]))
                    continue;
                judge_fixture_ask(c, ray[k]);
                struct hit hit = nearest(test, &c->scene, &ray[k]);
                count[verdict(c, hit)]++;
                honest_counted(&honest, c->judgement.verdict == VERDICT_WRONG);
                if (c->judgement.verdict == VERDICT_WRONG && honest.refused <= HONEST_SHOWN)
                    show(c, &hit, test->name, specs[s]);
                answers++;
                most = fmax(most, c->judgement.displacement);
                share = fmax(share, c->judgement.share);
            }
            judge_fixture_close(c);
        }
        print_message(
            "%-22s %zu answers, %zu boundary, %zu noise, largest displacement %.3g uM, of "
            "what is allowed there %.3f\n",
            test->name, answers, count[VERDICT_BOUNDARY], count[VERDICT_NOISE], most, share);
        refused += honest_ended(&honest, test->name);
    }
    free(ray);
    assert_int_equal(refused, 0);
}

/* Through a point of the triangle, almost in its plane. */
static struct ray grazing(struct rng *rng, const struct scene *scene, uint32_t prim)
{
    float v[3][3], a = rng_float(rng), b = rng_float(rng);
    double n[3], e1[3], e2[3], least = pow(10.0, -1.0 - 5.0 * (double)rng_float(rng));
    double turn = 6.2831853 * (double)rng_float(rng), away = 0.3 + 3.0 * (double)rng_float(rng);
    struct ray ray = {.tmax = RAY_TMAX};
    scene_tri(scene, prim, v);
    if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
    }
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)v[1][k] - (double)v[0][k];
        e2[k] = (double)v[2][k] - (double)v[0][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = e1[(k + 1) % 3] * e2[(k + 2) % 3] - e1[(k + 2) % 3] * e2[(k + 1) % 3];
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) {
        double d = cos(turn) * e1[k] + sin(turn) * e2[k];
        d += least * n[k] / (length > 0 ? sqrt(length) : 1.0);
        double at = (double)v[0][k] + (double)a * e1[k] + (double)b * e2[k];
        ray.dir[k] = (float)d;
        ray.org[k] = (float)(at - away * d);
    }
    return ray;
}

/* t, u and v then err by much, each by its own rounding. */
static void grazing_answers_are_never_wrong(void **state)
{
    (void)state;
    static const char *const meshes[] = {"sphere:n=8", "terrain:k=3", "soup:n=60"};
    struct rng rng = rng_make(11, 0);
    size_t tests = HONEST_PLAIN + (honest_fast_runs() ? HONEST_FAST : 0), far = 0;
    for (size_t s = 0; s < ARRAY_COUNT(meshes); s++) {
        struct judge_fixture *c = judge_fixture_open(meshes[s], 7);
        judge_fixture_seat(c, unknown, QUERY_ANY);
        for (size_t k = 0; k < 3000; k++) {
            uint32_t prim = rng_below(&rng, c->scene.tri_count);
            struct ray ray = grazing(&rng, &c->scene, prim);
            if (!ray_in_contract(&ray))
                continue;
            judge_fixture_ask(c, ray);
            for (size_t i = 0; i < tests; i++) {
                float v[3][3];
                struct hit hit = {.prim = prim};
                scene_tri(&c->scene, prim, v);
                if (!honest_at(i)->hits(&ray, (const float(*)[3])v, &hit))
                    continue;
                if (verdict(c, hit) == VERDICT_WRONG)
                    must_be(c, hit, VERDICT_RIGHT);
                struct judge_rounding r = judge_rounding_of(&ray, v);
                double u = fabs((double)hit.u - r.edge[1] / r.det);
                far += u * r.across[1] / fabs(r.det) > 1e-3;
            }
        }
        judge_fixture_close(c);
    }
    assert_true(far > 20); /* errors that no displacement of the point at t would excuse */
}

/* A point of the ray's line that is none of the triangle's is no barycentric of it. */
static void a_point_beside_the_triangle_is_not_weighed(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    judge_fixture_seat(c, unknown, QUERY_CLOSEST);
    judge_fixture_ask(
        c, (struct ray){{-3, -0.25f, 1}, 0, {1, 0, 0}, RAY_TMAX}); /* in the near layer */
    must_be(c, (struct hit){3.0f, 0.125f, 0.375f, 0}, VERDICT_IN_PLANE);
    must_be_wrong(c, (struct hit){3.0f, 2.125f, 0.375f, 0}, WRONG_BARYCENTRIC);
    must_be_wrong(c, (struct hit){3.0f, -40.0f, 0.375f, 0}, WRONG_BARYCENTRIC);
    judge_fixture_close(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(published_tests_are_never_wrong),
        cmocka_unit_test(grazing_answers_are_never_wrong),
        cmocka_unit_test(a_point_beside_the_triangle_is_not_weighed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
