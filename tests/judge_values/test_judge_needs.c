/* What an answer of an unpublished formula needs (ref/judge/judge_distance.c), by value: of a lost
 * hit the least way out, of weights where they lie, of the end of a range its share. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>
#include <string.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/judge_values/one_placed.h"

typedef long double wide;

#define SHARE 0x1p-20L

/* One triangle before a judge of an unknown formula. */
struct needing {
    struct scene scene;
    struct oracle *oracle;
    struct judge *judge;
    struct ray ray;
};

/* The ray goes to the point that these weights weigh, from afar or near to the plane. */
static void draw(struct rng *rng, struct needing *out, float u, float w, bool sliver)
{
    static const struct model unknown = {.formula = TWIN_UNKNOWN};
    int flat = sliver ? -8 - (int)rng_below(rng, 14) : 0;
    int low = (int)rng_below(rng, 3) ? 0 : -(int)rng_below(rng, 20);
    float *v, along = rng_range(rng, -0.25f, 1.25f);
    assert_int_equal(scene_make(3, 1, &out->scene), STATUS_OK);
    v = out->scene.vertex;
    out->ray = (struct ray){.tmin = 0, .tmax = INFINITY};
    for (uint32_t k = 0; k < 9; k++)
        v[k] = rng_range(rng, -1, 1);
    for (int k = 0; k < 3; k++) {
        float side = rng_range(rng, -1, 1);
        v[6 + k] = sliver ? v[k] + along * (v[3 + k] - v[k]) + ldexpf(side, flat) : v[6 + k];
        out->ray.org[k] = v[k] + 3 * (v[3 + k] - v[k]);
        out->ray.org[k] += ldexpf(rng_range(rng, -4, 4), low);
        float to = v[k] + u * (v[3 + k] - v[k]) + w * (v[6 + k] - v[k]);
        out->ray.dir[k] = to - out->ray.org[k];
        out->scene.index[k] = (uint32_t)k;
    }
    assert_int_equal(oracle_make(&out->scene, &out->oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(out->oracle, &unknown, QUERY_CLOSEST, &out->judge, NULL),
                     STATUS_OK);
}

static void done(struct needing *n)
{
    judge_free(n->judge);
    oracle_free(n->oracle);
    scene_free(&n->scene);
}

/* --- lost hits -------------------------------------------------------------------------------- */

struct way_out {
    wide need, over;
    enum verdict why;
};

static void consider(struct way_out *best, wide need, wide allowed, enum verdict why)
{
    if (need / allowed < best->over)
        *best = (struct way_out){need, need / allowed, why};
}

static void consider_plane(struct way_out *best, const struct needing *n,
                           const struct judge_rounding *r, double t, enum verdict why)
{
    wide off = 0, area = 0;
    if (!isfinite(t))
        return;
    for (int k = 0; k < 3; k++) {
        off += ((wide)t * (wide)r->tri.d[k] - (wide)r->tri.v[0][k]) * (wide)r->tri.n[k];
        area += (wide)r->tri.n[k] * (wide)r->tri.n[k];
    }
    consider(best, fabsl(off) / sqrtl(area) / (wide)r->tri.unit,
             2 * (wide)judge_plane_allowed(n->judge, r, t), why);
}

static void a_lost_hit_needs_the_least_way_out(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 56);
    size_t counts[VERDICT_COUNT] = {0};
    for (int i = 0; i < 6000; i++) {
        struct needing n;
        float u = rng_range(&rng, 0, 0.5f), w = rng_range(&rng, 0, 0.5f), off = 0;
        int power = -(int)rng_below(&rng, 26);
        u = i % 4 == 0 ? ldexpf(u, power) : u;
        draw(&rng, &n, u, w, i % 3 == 0);
        off = ldexpf(rng_range(&rng, 0, 1), power);
        double reach = rng_below(&rng, 2) ? INFINITY : 1 + (double)off;
        if (rng_below(&rng, 3) == 0)
            n.ray.tmax = 1 + off;
        if (rng_below(&rng, 3) == 0)
            n.ray.tmin = 1 - off;
        struct oracle_crossing crossing = {.prim = 0};
        oracle_pair(n.oracle, &n.ray, 0, &crossing.pair);
        struct judge_rounding r = judge_rounding_at(n.judge, &n.ray, 0);
        if (crossing.pair.class == ORACLE_INSIDE && ray_in_contract(&n.ray)) {
            struct way_out best = {INFINITY, INFINITY, VERDICT_BOUNDARY};
            for (int c = 0; c < 3; c++)
                consider(&best, fabsl((wide)judge_edge_distance(&r, c)),
                         (wide)judge_edge_allowed(n.judge, &r, c), VERDICT_BOUNDARY);
            consider_plane(&best, &n, &r, reach, VERDICT_NEAR_TIE);
            consider_plane(&best, &n, &r, (double)n.ray.tmin, VERDICT_BORDER);
            consider_plane(&best, &n, &r, (double)n.ray.tmax, VERDICT_BORDER);
            struct judge_loss loss = judge_loss_of(n.judge, &n.ray, &crossing, reach);
            assert_true(fabsl((wide)loss.over - best.over) <= 1e-9L * best.over + 1e-9L);
            assert_true(fabsl((wide)loss.need - best.need) <= 1e-9L * best.need + 1e-6L);
            assert_int_equal(loss.why, best.why);
            assert_true(loss.prim == 0 && loss.unit == r.tri.unit);
            assert_true(loss.t_lo == crossing.pair.t_lo && loss.t_hi == crossing.pair.t_hi);
            counts[loss.why]++;
        }
        done(&n);
    }
    print_message("boundary %zu, near tie %zu, border %zu\n", counts[VERDICT_BOUNDARY],
                  counts[VERDICT_NEAR_TIE], counts[VERDICT_BORDER]);
    assert_true(counts[VERDICT_BOUNDARY] > 200 && counts[VERDICT_NEAR_TIE] > 200);
    assert_true(counts[VERDICT_BORDER] > 200);
}

/* What the world may rule out, or a transform spoils, is lost for nothing. */
static void what_may_not_count_is_lost_for_nothing(void **state)
{
    (void)state;
    float v[3][3] = {{-1, -1, 3}, {2, -1, 3}, {-1, 2, 3}};
    float m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    struct oracle_crossing crossing = {.prim = 0};
    for (int i = 0; i < 3; i++) {
        struct one_placed one;
        m[0][2] = i == 2 ? 0x1p11f : 0;
        place(&one, v, m);
        one.judge.model.formula = TWIN_UNKNOWN;
        one.judge.mode.mask = i == 1 ? 0 : 0xFF;
        struct judge_loss loss = judge_loss_of(&one.judge, &ray, &crossing, INFINITY);
        assert_int_equal(loss.need > 0 && loss.over > 0, i == 0);
        assert_true(i == 0 || (loss.need == 0 && loss.over == 0));
        assert_int_equal(loss.why, i == 2 ? VERDICT_OUT_OF_CONTRACT : VERDICT_BOUNDARY);
        world_free(&one.world);
    }
}

/* --- hits ------------------------------------------------------------------------------------- */

struct share_of {
    wide share, need;
    bool noise;
};

/* The distance of the ray's point to the triangle, or, of what may be accepted, to its plane. */
static struct share_of share_at(const struct judge *judge, const struct judge_rounding *r, double t)
{
    wide need = (wide)judge_point_displacement(&r->tri, t);
    wide plane = (wide)ray_triangle_plane_distance(t, &r->tri) / (wide)r->tri.unit;
    struct share_of out = {need / (wide)judge->displacement, need, false};
    if (!judge_may_accept(judge, r))
        return out;
    if (out.share > 1) {
        out.need = plane;
        out.noise = judge_det_is_open(r);
    }
    out.share = fminl(out.share, plane / (wide)judge_plane_allowed(judge, r, t));
    return out;
}

static void a_hit_needs_what_its_point_is_off(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 56);
    size_t counts[WRONG_COUNT] = {0}, noise = 0;
    for (int i = 0; i < 20000; i++) {
        struct needing n;
        float u = rng_range(&rng, -0.2f, 0.8f), off = rng_range(&rng, -1, 1);
        u = rng_below(&rng, 2) ? ldexpf(u, -(int)rng_below(&rng, 26)) : u;
        draw(&rng, &n, u, 0.25f, i % 4 != 0);
        off = ldexpf(off, -(int)rng_below(&rng, 26));
        struct hit hit = {rng_below(&rng, 8) ? 1 + off : 40, u < 0 ? 0 : u, 0.25f, 0};
        const struct oracle_answer truth = {.prim = i % 2 ? 0 : ABI_NO_PRIM, .tie_count = 1};
        struct judgement out = {.verdict = VERDICT_RIGHT};
        struct oracle_pair pair;
        float v[3][3];
        struct judge_rounding r = judge_rounding_at(n.judge, &n.ray, 0);
        struct share_of at = share_at(n.judge, &r, (double)hit.t);
        scene_tri(&n.scene, 0, v);
        oracle_pair(n.oracle, &n.ray, 0, &pair);
        double exact = (double)(float)judge_plane_t(&n.ray, v);
        bool there = pair.det != 0 && share_at(n.judge, &r, exact).share <= 1;
        if (ray_in_contract(&n.ray) && hit.t >= 0 && fabsl(at.share - 1) > 1e-9L) {
            judge_named_by_distance(n.judge, &n.ray, &truth, &hit, &out);
            assert_true(fabsl((wide)out.share - at.share) <= 1e-9L * at.share);
            assert_true(fabsl((wide)out.displacement - at.need) <= 1e-9L * at.need);
            if (at.share > 1)
                assert_int_equal(out.wrong, there   ? WRONG_DISTANCE
                                            : i % 2 ? WRONG_TRIANGLE
                                                    : WRONG_PHANTOM);
            else
                assert_true(out.wrong == WRONG_NOT || out.wrong == WRONG_BARYCENTRIC);
            counts[out.wrong]++;
        }
        hit.u = (float)(r.edge[1] / r.det);
        hit.v = (float)(r.edge[2] / r.det);
        out = (struct judgement){.verdict = VERDICT_RIGHT};
        if (ray_in_contract(&n.ray) && hit.t >= 0 && at.share < 0.999L && isfinite(hit.u) &&
            isfinite(hit.v)) {
            enum verdict found = judge_named_by_distance(n.judge, &n.ray, &truth, &hit, &out);
            enum verdict usual = judge_by_pair(n.judge, &n.ray, 0, &pair);
            assert_true(found == VERDICT_WRONG || found == (at.noise ? VERDICT_NOISE : usual));
            noise += found == VERDICT_NOISE;
        }
        done(&n);
    }
    print_message("distance %zu, triangle %zu, phantom %zu, noise %zu\n", counts[WRONG_DISTANCE],
                  counts[WRONG_TRIANGLE], counts[WRONG_PHANTOM], noise);
    assert_true(counts[WRONG_DISTANCE] > 100 && counts[WRONG_TRIANGLE] > 100);
    assert_true(counts[WRONG_PHANTOM] > 100 && noise > 20);
}

/* --- weights ---------------------------------------------------------------------------------- */

/* Their point may be moved onto the line of the ray, on the triangle; or the classical test may
 * come to them. *near: a matter of the last digits. */
static bool weights_fit(const struct judge_rounding *r, float u, float w, bool *near)
{
    wide across[3], length = 0, off = 0, most = (32 + (wide)r->extra) * (wide)r->tri.unit;
    double p[3];
    for (int k = 0; k < 3; k++)
        p[k] = (1 - (double)u - (double)w) * r->tri.v[0][k] + (double)u * r->tri.v[1][k] +
               (double)w * r->tri.v[2][k];
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        across[k] = (wide)p[i] * (wide)r->tri.d[j] - (wide)p[j] * (wide)r->tri.d[i];
        off += across[k] * across[k];
        length += (wide)r->tri.d[k] * (wide)r->tri.d[k];
    }
    off = sqrtl(off / length);
    wide beside = (wide)ray_triangle_distance(p, &r->tri);
    *near = fabsl(off - most) <= 1e-8L * most || fabsl(beside - most) <= 1e-8L * most;
    if (off <= most && beside <= most)
        return true;
    return (wide)u >= -SHARE && (wide)w >= -SHARE && (wide)u + (wide)w <= 1 + SHARE &&
           judge_weight_allowed(r, 1, (double)u) && judge_weight_allowed(r, 2, (double)w);
}

static float pick(struct rng *rng)
{
    static const float at[] = {
        0, 0, 0.5f, 1, -0x1p-20f, -0x1.000002p-20f, -0x1p-19f, 1 + 0x1p-20f, 1 + 0x1.8p-20f};
    float any = rng_range(rng, 0, 0.5f);
    uint32_t which = rng_below(rng, 2 * ARRAY_COUNT(at));
    return which < ARRAY_COUNT(at) ? at[which] : any;
}

static void weights_are_those_of_a_point_on_the_ray_or_of_the_classical_test(void **state)
{
    (void)state;
    struct rng rng = rng_make(2, 56);
    size_t fit = 0, not = 0, border = 0;
    for (int i = 0; i < 40000; i++) {
        struct needing n;
        float u = pick(&rng), w = pick(&rng);
        draw(&rng, &n, u, w, i % 8 != 0);
        const struct oracle_answer truth = {.prim = 0, .tie_count = 1};
        struct judgement out = {.verdict = VERDICT_RIGHT};
        struct hit hit = {1, u, w, 0};
        float off = rng_range(&rng, -1, 1);
        if (rng_below(&rng, 4) == 0)
            hit.u += ldexpf(off, -(int)rng_below(&rng, 24));
        else if (rng_below(&rng, 2)) /* a sum at its border, where the ray does not go */
            hit.u = 1 - hit.v + (float)(int)rng_below(&rng, 4) * 0x1p-21f;
        bool near = false;
        struct judge_rounding r = judge_rounding_at(n.judge, &n.ray, 0);
        bool may = weights_fit(&r, hit.u, hit.v, &near);
        if (ray_in_contract(&n.ray) && !near) {
            judge_named_by_distance(n.judge, &n.ray, &truth, &hit, &out);
            if (out.wrong == WRONG_NOT || out.wrong == WRONG_BARYCENTRIC) {
                assert_int_equal(out.wrong, may ? WRONG_NOT : WRONG_BARYCENTRIC);
                fit += may;
                not += !may;
                border += may && (hit.u == -0x1p-20f || hit.v == -0x1p-20f ||
                                  (double)hit.u + (double)hit.v == 1 + 0x1p-20);
            }
        }
        done(&n);
    }
    print_message("%zu fit, %zu do not, %zu at a border\n", fit, not, border);
    assert_true(fit > 5000 && not > 500 && border > 200);
}

/* --- the end of a range ----------------------------------------------------------------------- */

static void an_answer_may_lie_beyond_the_range_by_the_share_of_its_model(void **state)
{
    (void)state;
    static const double shares[] = {0, 0x1p-20, 0x1p-16};
    struct rng rng = rng_make(3, 56);
    size_t kept = 0, refused = 0;
    for (int i = 0; i < 6000; i++) {
        struct needing n;
        draw(&rng, &n, 0.25f, 0.25f, false);
        const struct oracle_answer truth = {.prim = 0, .tie_count = 1};
        struct judgement out = {.verdict = VERDICT_RIGHT};
        struct judge judge = *n.judge;
        judge.beyond = shares[i % 3];
        judge.displacement = 1e9; /* so that only the range counts */
        float t = 1 + (float)((int)rng_below(&rng, 9) - 4) * 0x1p-20f;
        struct hit hit = {t, 0.25f, 0.25f, 0};
        bool end = rng_below(&rng, 2);
        if (end)
            n.ray.tmax = rng_below(&rng, 2) ? 1 : 1 - 0x1p-16f;
        else
            n.ray.tmin = rng_below(&rng, 2) ? 1 : 1 + 0x1p-16f;
        wide lo = (wide)n.ray.tmin * (1 - (wide)judge.beyond);
        wide hi = (wide)n.ray.tmax * (1 + (wide)judge.beyond);
        bool in = (wide)t >= lo && (wide)t <= hi;
        judge.model.open = rng_below(&rng, 2);
        if (judge.model.open && judge.beyond == 0)
            in = t > n.ray.tmin && t < n.ray.tmax;
        judge_named_by_distance(&judge, &n.ray, &truth, &hit, &out);
        assert_int_equal(out.wrong, in ? WRONG_NOT : WRONG_DISTANCE);
        kept += in;
        refused += !in;
        done(&n);
    }
    assert_true(kept > 1000 && refused > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lost_hit_needs_the_least_way_out),
        cmocka_unit_test(what_may_not_count_is_lost_for_nothing),
        cmocka_unit_test(a_hit_needs_what_its_point_is_off),
        cmocka_unit_test(weights_are_those_of_a_point_on_the_ray_or_of_the_classical_test),
        cmocka_unit_test(an_answer_may_lie_beyond_the_range_by_the_share_of_its_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
