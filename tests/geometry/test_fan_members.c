/* Closed fans against their definition in ref/judge/judge_fan.c, written anew without a topology:
 * whether a fan is closed and how far its answer may lie, for fans of every kind, with ends of the
 * range as near to them as their errors are. */
#include "ref/base/rng.h"
#include "ref/judge/judge_inner.h"
#include "scenes/scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define MEMBERS_MOST 1024u
#define BAND         32.0L /* of an unknown formula, in u * max |vertex - origin| */
#define TRIALS       4000u

static const struct model woop = {
    .formula = TWIN_WOOP, .rounding = {1, 1, 1, 0x1p-149}, .bits = true, .watertight = true};
static const struct model unknown = {.formula = TWIN_UNKNOWN, .displacement = 48};

/* --- the definition -------------------------------------------------------------------------- */

struct definition {
    const struct scene *scene;
    const struct oracle *oracle;
    const struct model *model;
    const struct ray *ray;
    const struct judge_found *found;
    bool close; /* a comparison that rounding may decide either way */
};

/* Of one triangle: whether its t lies inside the range, the signs that are proven, the largest t.
 */
struct proven {
    bool inside;
    int det, edge[3];
    long double most;
};

static long double dot(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const long double a[3], const long double b[3], long double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static struct proven proven_by_twin(const struct definition *def, float v[3][3])
{
    struct twin twin = twin_eval(def->model->formula, def->model->rounding, def->ray, v);
    double most = twin.t_err + twin.t_off;
    return (struct proven){.inside = twin.t_near - most > (double)def->ray->tmin &&
                                     twin.t_near + most < (double)def->ray->tmax,
                           .det = twin.det,
                           .edge = {twin.edge[0], twin.edge[1], twin.edge[2]},
                           .most = (long double)twin.t_near + 2 * (long double)most};
}

/* In units of the largest coordinate from the origin of the ray. */
static struct proven proven_by_distance(struct definition *def, float v[3][3], uint32_t prim)
{
    struct oracle_pair pair;
    long double p[3][3], d[3], n[3], unit = 0;
    oracle_pair(def->oracle, def->ray, prim, &pair);
    struct proven out = {.det = pair.det};
    for (int k = 0; k < 3; k++) {
        d[k] = (long double)def->ray->dir[k];
        for (int c = 0; c < 3; c++) {
            p[c][k] = (long double)v[c][k] - (long double)def->ray->org[k];
            unit = fmaxl(unit, 0x1p-24L * fabsl(p[c][k]));
        }
    }
    for (int c = 0; c < 3; c++) {
        long double side[3], across[3];
        for (int k = 0; k < 3; k++)
            side[k] = p[(c + 2) % 3][k] - p[(c + 1) % 3][k];
        cross(d, side, across);
        long double far = fabsl(dot(p[(c + 1) % 3], across)) / sqrtl(dot(across, across)) / unit;
        def->close = def->close || fabsl(far - BAND) < 1e-5L || !isfinite(far);
        out.edge[c] = far > BAND ? pair.edge[c] : 0;
    }
    long double ab[3], ac[3];
    for (int k = 0; k < 3; k++)
        ab[k] = p[1][k] - p[0][k], ac[k] = p[2][k] - p[0][k];
    cross(ab, ac, n);
    long double t = dot(p[0], n) / dot(d, n);
    long double of_t = unit * sqrtl(dot(n, n)) / fabsl(dot(d, n));
    out.inside = t - BAND * of_t > (long double)def->ray->tmin &&
                 t + BAND * of_t < (long double)def->ray->tmax;
    out.most = t + fmaxl(BAND, (long double)def->model->displacement) * of_t;
    return out;
}

/* How many triangles run from a to b; *other is the last. */
static int runs_along(const struct scene *scene, const float a[3], const float b[3],
                      uint32_t *other)
{
    int count = 0;
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        for (int c = 0; c < 3; c++) {
            bool here = true;
            for (int k = 0; k < 3; k++)
                here = here && v[c][k] == a[k] && v[(c + 1) % 3][k] == b[k];
            if (here)
                count++, *other = i;
        }
    }
    return count;
}

static bool is_found(const struct judge_found *found, uint32_t prim)
{
    for (size_t i = 0; found && i < found->count; i++)
        if (found->slot[i].prim == prim)
            return true;
    return false;
}

static bool fan_by_definition(struct definition *def, uint32_t first, long double *limit)
{
    static uint32_t member[MEMBERS_MOST];
    size_t count = 1;
    int sign = 0;
    bool rim = false;
    member[0] = first;
    *limit = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(def->scene, member[i], v);
        if (is_found(def->found, member[i]))
            return false;
        struct proven proven = def->model->formula == TWIN_UNKNOWN
                                   ? proven_by_distance(def, v, member[i])
                                   : proven_by_twin(def, v);
        sign = i == 0 ? proven.det : sign;
        if (!proven.inside || proven.det == 0 || proven.det != sign)
            return false;
        *limit = fmaxl(*limit, proven.most);
        for (int c = 0; c < 3; c++) {
            const float *a = v[(c + 1) % 3], *b = v[(c + 2) % 3];
            uint32_t same = 0, other = 0;
            bool joined = false;
            if (proven.edge[c] == sign) {
                rim = true;
                continue;
            }
            if (runs_along(def->scene, a, b, &same) != 1 ||
                runs_along(def->scene, b, a, &other) != 1)
                return false;
            for (size_t k = 0; k < count; k++)
                joined = joined || member[k] == other;
            if (!joined && count == MEMBERS_MOST)
                return false;
            if (!joined)
                member[count++] = other;
        }
    }
    return rim;
}

/* --- trials ---------------------------------------------------------------------------------- */

struct fans {
    struct scene scene;
    struct oracle *oracle;
    struct judge *judge[2];
    size_t closed[2], open[2], close;
};

static const struct model *const models[2] = {&woop, &unknown};

static void fans_make(struct fans *f)
{
    struct reason reason = {""};
    if (oracle_make(&f->scene, &f->oracle, &reason))
        fail_msg("%s", reason.text);
    for (int m = 0; m < 2; m++)
        if (judge_make(f->oracle, models[m], QUERY_CLOSEST, &f->judge[m], &reason))
            fail_msg("%s", reason.text);
}

static void fans_free(struct fans *f)
{
    for (int m = 0; m < 2; m++)
        judge_free(f->judge[m]);
    oracle_free(f->oracle);
    scene_free(&f->scene);
}

/* Both fans of a triangle are as defined. */
static void check_fan(struct fans *f, const struct ray *ray, uint32_t prim,
                      const struct judge_found *found)
{
    for (int m = 0; m < 2; m++) {
        struct definition def = {&f->scene, f->oracle, models[m], ray, found, false};
        long double most;
        double limit = 0;
        bool closed = true, defined = fan_by_definition(&def, prim, &most);
        assert_int_equal(judge_fan(f->judge[m], ray, prim, found, &closed, &limit), STATUS_OK);
        f->close += def.close;
        if (def.close)
            continue;
        if (closed != defined ||
            (closed && fabsl((long double)limit - most) > 1e-12L * fabsl(most)))
            fail_msg("model %d: %d at %a, by definition %d at %La", m, closed, limit, defined,
                     most);
        f->closed[m] += closed;
        f->open[m] += !closed;
    }
}

/* At a corner, a point of an edge, beside it, or at an inside; ends of the range at its t, a few
 * times its error away, or far. */
static struct ray draw_ray(const struct scene *scene, struct rng *rng, uint32_t prim)
{
    struct ray ray = {.tmin = 0, .tmax = 1e30f};
    float v[3][3], weight[3] = {1, 0, 0};
    scene_tri(scene, prim, v);
    uint32_t what = rng_below(rng, 8), first = rng_below(rng, 3);
    if (what >= 2)
        weight[1] = rng_float(rng);
    if (what == 7)
        weight[2] = rng_float(rng) * (1 - weight[1]);
    weight[0] -= weight[1] + weight[2];
    float off = what == 6 ? rng_scaled(rng, -1, 1, -23, 12) : 0;
    for (int k = 0; k < 3; k++) {
        float target = off;
        for (uint32_t c = 0; c < 3; c++)
            target += weight[c] * v[(first + c) % 3][k];
        ray.org[k] = rng_range(rng, -0.5f, 0.5f);
        ray.dir[k] = target - ray.org[k];
    }
    struct twin twin = twin_eval(TWIN_WOOP, woop.rounding, &ray, v);
    double most = twin.t_err + twin.t_off;
    if (isfinite(most) && rng_below(rng, 2)) {
        double from = twin.t_near - (double)rng_range(rng, 0, 3) * most;
        double to = twin.t_near + (double)rng_range(rng, 0, 3) * most;
        uint32_t ends = rng_below(rng, 3);
        ray.tmin = ends == 0 && from > 0 ? (float)from : 0;
        ray.tmax = ends == 1 && to > 0 ? (float)to : 1e30f;
    }
    return ray;
}

/* Takes triangles away, turns some round, or has some twice. */
static void damage(struct scene *scene, struct rng *rng)
{
    for (uint32_t n = rng_below(rng, 4); n > 0; n--) {
        uint32_t *one = scene->index + 3 * (size_t)rng_below(rng, scene->tri_count);
        const uint32_t *another = scene->index + 3 * (size_t)rng_below(rng, scene->tri_count);
        uint32_t first = one[0];
        if (rng_below(rng, 3) == 0)
            memmove(one, another, 3 * sizeof *one);
        else
            one[0] = one[1], one[1] = first;
    }
}

static void a_fan_is_closed_as_it_is_defined(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=3", "sphere:n=6", "platonic"};
    struct rng rng = rng_make(7, 0);
    size_t closed[2] = {0}, open[2] = {0}, close = 0;
    for (uint32_t world = 0; world < 24; world++) {
        struct fans f = {.close = 0};
        struct reason reason = {""};
        if (scene_open(specs[world % ARRAY_COUNT(specs)], 1, &f.scene, &reason))
            fail_msg("%s", reason.text);
        if (world >= ARRAY_COUNT(specs))
            damage(&f.scene, &rng);
        fans_make(&f);
        for (uint32_t i = 0; i < TRIALS / 24; i++) {
            uint32_t prim = rng_below(&rng, f.scene.tri_count);
            struct ray ray = draw_ray(&f.scene, &rng, prim);
            struct judge_slot slot = {rng_below(&rng, f.scene.tri_count), 0};
            struct judge_found found = {&slot, rng_below(&rng, 2)};
            check_fan(&f, &ray, prim, i % 2 ? &found : NULL);
        }
        for (int m = 0; m < 2; m++)
            closed[m] += f.closed[m], open[m] += f.open[m];
        close += f.close;
        fans_free(&f);
    }
    assert_true(closed[0] > TRIALS / 4 && closed[1] > TRIALS / 4);
    assert_true(open[0] > TRIALS / 8 && open[1] > TRIALS / 8);
    assert_true(close < TRIALS / 100);
}

/* A cone of n triangles around a tip, open below, and a ray at its tip. */
static void check_cone(uint32_t n, bool closed)
{
    struct fans f = {.close = 0};
    assert_int_equal(scene_make(n + 1, n, &f.scene), STATUS_OK);
    f.scene.vertex[2] = 1;
    for (uint32_t i = 0; i < n; i++) {
        double angle = 6.283185307179586 * i / n;
        float *rim = f.scene.vertex + 3 * (size_t)(i + 1);
        rim[0] = (float)cos(angle), rim[1] = (float)sin(angle), rim[2] = 1.5f;
        uint32_t *index = f.scene.index + 3 * (size_t)i;
        index[0] = 0, index[1] = 1 + i, index[2] = 1 + (i + 1) % n;
    }
    fans_make(&f);
    const struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, 1e30f};
    check_fan(&f, &ray, n / 2, NULL);
    assert_true(f.closed[0] == closed && f.closed[1] == closed && f.close == 0);
    fans_free(&f);
}

static void a_fan_has_at_most_1024_triangles(void **state)
{
    (void)state;
    check_cone(4, true);
    check_cone(MEMBERS_MOST, true);
    check_cone(MEMBERS_MOST + 1, false);
}

/* --- borders, where every number is exact ---------------------------------------------------- */

/* A square across the z axis at z = 2, four triangles around its middle: coordinates are at most 2,
 * so that 32 units are 2^-18, and t is moved by as much. */
#define EXACT_BAND 0x1p-18f

static void square_make(struct fans *f)
{
    static const float vertex[5][3] = {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {-1, 0, 2}, {0, -1, 2}};
    static const uint32_t index[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    assert_int_equal(scene_make(5, 4, &f->scene), STATUS_OK);
    memcpy(f->scene.vertex, vertex, sizeof vertex);
    memcpy(f->scene.index, index, sizeof index);
    fans_make(f);
}

static bool unknown_is_closed(struct fans *f, const struct ray *ray, uint32_t found_one)
{
    bool closed;
    double limit;
    struct judge_slot slot = {found_one, 0};
    const struct judge_found found = {&slot, 1};
    assert_int_equal(judge_fan(f->judge[1], ray, 0, &found, &closed, &limit), STATUS_OK);
    return closed;
}

static void a_band_must_lie_inside_the_range(void **state)
{
    (void)state;
    static const float end[2] = {2 - EXACT_BAND, 2 + EXACT_BAND};
    struct fans f = {.close = 0};
    square_make(&f);
    for (int side = 0; side < 2; side++)
        for (int to = -1; to <= 1; to++) {
            struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, 1e30f};
            *(side ? &ray.tmax : &ray.tmin) =
                to ? nextafterf(end[side], to > 0 ? 3 : 0) : end[side];
            assert_int_equal(unknown_is_closed(&f, &ray, 4), to == (side ? 1 : -1));
        }
    fans_free(&f);
}

/* The triangle on the other side of an edge belongs to the fan if that is at most 32 units away. */
static void an_edge_is_open_up_to_the_band(void **state)
{
    (void)state;
    struct fans f = {.close = 0};
    square_make(&f);
    for (int to = -1; to <= 1; to++) {
        float y = to ? nextafterf(EXACT_BAND, to > 0 ? 1 : 0) : EXACT_BAND;
        struct ray ray = {{0.25f, y, 0}, 0, {0, 0, 1}, 1e30f};
        assert_int_equal(unknown_is_closed(&f, &ray, 3), to == 1);
        assert_true(unknown_is_closed(&f, &ray, 2));
    }
    fans_free(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fan_is_closed_as_it_is_defined),
        cmocka_unit_test(a_fan_has_at_most_1024_triangles),
        cmocka_unit_test(a_band_must_lie_inside_the_range),
        cmocka_unit_test(an_edge_is_open_up_to_the_band),
    };
    return cmocka_run_group_tests_name("fan_members", tests, NULL, NULL) ? 1 : 0;
}
