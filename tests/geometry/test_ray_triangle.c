/* Triangles as a ray sees them, each number against its formula written anew in long double, in
 * scenes and placed; and which coordinates a judge takes, to the last bit. */
#include "ref/base/rng.h"
#include "ref/judge/judge_inner.h"
#include "ref/oracle/oracle_world.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

typedef long double real;

static real dot(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static real length_of(const real a[3])
{
    return sqrtl(dot(a, a));
}

static void cross(const real a[3], const real b[3], real out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void less(const real a[3], const real b[3], real out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static void near_to(double got, real want, real scale)
{
    if (!(fabsl((real)got - want) <= 1e-13L * scale))
        fail_msg("%a is not %La, at %La", got, want, scale);
}

/* The nearest point of segment ab, by where its foot lies. */
static real from_segment(const real p[3], const real a[3], const real b[3])
{
    real ab[3], ap[3], bp[3], across[3];
    less(b, a, ab);
    less(p, a, ap);
    less(p, b, bp);
    if (dot(ab, ap) <= 0)
        return length_of(ap);
    if (dot(ab, bp) >= 0)
        return length_of(bp);
    cross(ab, ap, across);
    return length_of(across) / length_of(ab);
}

/* Above the triangle, the foot's three parts of the area have one sign. */
static real from_triangle(const real p[3], const real v[3][3])
{
    real ab[3], ac[3], n[3], least = INFINITY;
    bool above = true;
    less(v[1], v[0], ab);
    less(v[2], v[0], ac);
    cross(ab, ac, n);
    for (int c = 0; c < 3; c++) {
        real a[3], b[3], part[3];
        least = fminl(least, from_segment(p, v[c], v[(c + 1) % 3]));
        less(v[c], p, a);
        less(v[(c + 1) % 3], p, b);
        cross(a, b, part);
        above = above && dot(part, n) > 0;
    }
    less(p, v[0], ab);
    return above ? fabsl(dot(ab, n)) / length_of(n) : least;
}

/* All of a triangle whose vertices relative to the origin of the ray are these. */
static void check_triangle(const struct ray *ray, const struct ray_triangle *tri,
                           const real v[3][3], struct rng *rng)
{
    real d[3], side[3][3], n[3], most = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = (real)ray->dir[k];
        for (int c = 0; c < 3; c++)
            most = fmaxl(most, fabsl(v[c][k]));
    }
    for (int c = 0; c < 3; c++)
        less(v[(c + 1) % 3], v[c], side[c]);
    cross(side[0], side[1], n);
    for (int k = 0; k < 3; k++) {
        assert_true(tri->d[k] == (double)ray->dir[k]);
        near_to(tri->n[k], n[k], 4 * most * most);
        for (int c = 0; c < 3; c++) {
            near_to(tri->v[c][k], v[c][k], 4 * most);
            near_to(tri->side[c][k], side[c][k], 4 * most);
        }
    }
    near_to(tri->area, length_of(n), 4 * most * most);
    near_to(tri->unit, 0x1p-24L * most, 0x1p-24L * most);
    for (int i = 0; i < 8; i++) {
        double p[3], t = (double)rng_range(rng, -1, 3);
        real q[3], at[3], off[3];
        for (int k = 0; k < 3; k++) {
            p[k] = (double)(v[i % 3][k] + (real)rng_range(rng, -1, 1) * (real)(i % 4) * most);
            q[k] = (real)p[k];
            at[k] = (real)t * d[k];
        }
        less(at, v[0], off);
        real reach = most + length_of(q) + length_of(at);
        near_to(ray_triangle_distance(p, tri), from_triangle(q, v), 1e3L * reach);
        near_to(ray_triangle_distance_at(t, tri), from_triangle(at, v), 1e3L * reach);
        near_to(judge_point_displacement(tri, t), from_triangle(at, v) / (0x1p-24L * most),
                1e3L * reach / (0x1p-24L * most));
        near_to(ray_triangle_plane_distance(t, tri), fabsl(dot(off, n)) / length_of(n),
                1e3L * reach);
        cross(q, d, off);
        near_to(ray_triangle_line_distance(p, tri), length_of(off) / length_of(d), 1e3L * reach);
    }
}

static void every_number_is_that_of_its_formula(void **state)
{
    (void)state;
    struct rng rng = rng_make(11, 0);
    for (int i = 0; i < 5000; i++) {
        struct ray ray = {.tmax = 1};
        float v[3][3], m[3][4];
        real at[3][3], placed[3][3], ab[3], ac[3], d[3], n[3];
        for (int k = 0; k < 3; k++) {
            ray.org[k] = rng_range(&rng, -1, 1);
            ray.dir[k] = rng_range(&rng, -1, 1);
            d[k] = (real)ray.dir[k];
            for (int c = 0; c < 3; c++) {
                v[c][k] = rng_range(&rng, -1, 1);
                at[c][k] = (real)v[c][k] - (real)ray.org[k];
            }
            for (int j = 0; j < 4; j++)
                m[k][j] = rng_range(&rng, -2, 2);
        }
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                placed[c][k] = (real)m[k][3] - (real)ray.org[k];
                for (int j = 0; j < 3; j++)
                    placed[c][k] += (real)m[k][j] * (real)v[c][j];
            }
        less(at[1], at[0], ab);
        less(at[2], at[0], ac);
        cross(ab, ac, n);
        if (length_of(n) < 0.02L || fabsl(dot(d, n)) < 0.002L)
            continue;
        near_to(judge_plane_t(&ray, v), dot(at[0], n) / dot(d, n), 1e4L);
        struct ray_triangle tri = ray_triangle_of(&ray, v);
        check_triangle(&ray, &tri, (const real(*)[3])at, &rng);
        less(placed[1], placed[0], ab);
        less(placed[2], placed[0], ac);
        cross(ab, ac, n);
        if (length_of(n) < 0.02L)
            continue;
        tri = ray_triangle_placed(&ray, (const float(*)[4])m, v);
        check_triangle(&ray, &tri, (const real(*)[3])placed, &rng);
    }
}

/* Points and lines in place of triangles, and a ray that stands still: no number is infinite. */
static void what_has_no_area_has_no_plane(void **state)
{
    (void)state;
    const struct ray ray = {{0, 0, 0}, 0, {0, 0, 2}, 1}, still = {{0, 0, 0}, 0, {0, 0, 0}, 1};
    float line[3][3] = {{3, 0, 4}, {3, 0, 4}, {3, 0, 8}},
          point[3][3] = {{3, 0, 4}, {3, 0, 4}, {3, 0, 4}};
    float origin[3][3] = {{0}};
    const double p[3] = {3, 4, 0};
    struct ray_triangle tri = ray_triangle_of(&ray, line);
    assert_true(tri.area == 0 && tri.unit == 8 * JUDGE_UNIT);
    assert_true(ray_triangle_plane_distance(7, &tri) == 0 &&
                ray_triangle_distance_at(3, &tri) == 3);
    assert_true(ray_triangle_distance_at(0, &tri) == 5 && ray_triangle_distance_at(6, &tri) == 5);
    assert_true(ray_triangle_line_distance(p, &tri) == 5);
    tri = ray_triangle_of(&still, point);
    assert_true(ray_triangle_line_distance(p, &tri) == 0 && ray_triangle_distance_at(9, &tri) == 5);
    tri = ray_triangle_of(&ray, origin);
    assert_true(tri.unit == 0 && judge_point_displacement(&tri, 1) == 0);
}

/* --- what a judge takes ---------------------------------------------------------------------- */

#define LARGEST 0x1p40f

static struct scene one_triangle(float x, float y, float z)
{
    struct scene scene;
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    const float vertex[9] = {-x, 0, 0, x / 2, y, 0, 0, -y / 2, z};
    const uint32_t index[3] = {0, 1, 2};
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    return scene;
}

static void coordinates_are_taken_up_to_a_limit(void **state)
{
    (void)state;
    static const struct model model = {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}};
    for (uint32_t at = 0; at < 9; at++)
        for (int sign = -1; sign <= 1; sign += 2)
            for (int beyond = 0; beyond < 2; beyond++) {
                struct scene scene = one_triangle(1, 1, 1);
                struct oracle *oracle;
                struct judge *judge;
                scene.vertex[at] = (float)sign * (beyond ? nextafterf(LARGEST, INFINITY) : LARGEST);
                assert_int_equal(oracle_make(&scene, &oracle, NULL), STATUS_OK);
                assert_int_equal(judge_make(oracle, &model, QUERY_ANY, &judge, NULL), STATUS_OK);
                assert_int_equal(judge->in_contract, !beyond);
                for (uint32_t k = 0; k < 3; k++) {
                    float largest = 0;
                    for (uint32_t c = 0; c < 3; c++)
                        largest = fmaxf(largest, fabsf(scene.vertex[3 * c + k]));
                    assert_true(judge->largest[k] == largest);
                }
                judge_free(judge);
                oracle_free(oracle);
                scene_free(&scene);
            }
}

/* Two meshes, three instances: of the large mesh the last two. */
struct taken_world {
    struct scene scene[2];
    struct geometry geometry[2];
    struct world_mesh mesh[2];
    struct instance instance[3];
};

static void taken_make(struct taken_world *t, float x, float y, float z)
{
    t->scene[0] = one_triangle(1, 1, 1);
    t->scene[1] = one_triangle(x, y, z);
    for (uint32_t i = 0; i < 2; i++) {
        t->geometry[i] = (struct geometry){.count = 1, .opaque = true};
        t->mesh[i] = (struct world_mesh){&t->scene[i], &t->geometry[i], 1};
    }
    for (uint32_t i = 0; i < 3; i++) {
        t->instance[i] = (struct instance){.mesh = i > 0, .mask = 255};
        for (int k = 0; k < 3; k++)
            t->instance[i].m[k][k] = 1;
    }
}

/* Whether the judge takes it; *status: what it was made with. */
static bool is_taken(struct taken_world *t, enum status *status)
{
    static const struct model model = {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}};
    struct world world = {.mesh = t->mesh,
                          .instance = t->instance,
                          .mesh_count = 2,
                          .instance_count = 3,
                          .borrows = true};
    struct oracle *oracle;
    struct judge *judge;
    struct reason reason = {""};
    bool taken = false;
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle, NULL), STATUS_OK);
    *status = judge_make(oracle, &model, QUERY_ANY, &judge, &reason);
    if (*status) {
        assert_null(judge);
        assert_true(strncmp(reason.text, "instance 1: ", 12) == 0);
    } else {
        taken = judge->in_contract;
    }
    judge_free(judge);
    oracle_free(oracle);
    free(world.first);
    return taken;
}

/* A row of a transform reaches |T| + sum of |m| times the mesh's largest coordinates; here each of
 * the four is a quarter of the limit. */
static void placed_coordinates_are_taken_up_to_the_limit(void **state)
{
    (void)state;
    const float axis[3] = {0x1p37f, 0x1p36f, 0x1p35f};
    struct taken_world t;
    enum status status;
    taken_make(&t, axis[0], axis[1], axis[2]);
    for (int which = 1; which < 3; which++)
        for (int k = 0; k < 3; k++)
            for (int grown = -1; grown < 4; grown++) {
                struct instance kept = t.instance[which];
                float *row = t.instance[which].m[k];
                for (int j = 0; j < 4; j++)
                    row[j] = (j % 2 ? -1.0f : 1.0f) * (j < 3 ? LARGEST / 4 / axis[j] : LARGEST / 4);
                if (grown >= 0)
                    row[grown] = nextafterf(row[grown], row[grown] * 2);
                assert_int_equal(is_taken(&t, &status), grown < 0);
                assert_int_equal(status, STATUS_OK);
                t.instance[which] = kept;
            }
    for (int k = 0; k < 3; k++) { /* the mesh itself is beyond, however small it is placed */
        float *last = &t.scene[1].vertex[k], was = *last;
        for (int beyond = 0; beyond < 2; beyond++) {
            *last = beyond ? nextafterf(LARGEST, INFINITY) : LARGEST;
            for (int i = 1; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    t.instance[i].m[j][j] = 0x1p-9f;
            assert_int_equal(is_taken(&t, &status), !beyond);
        }
        *last = was;
    }
    t.instance[1].m[2][2] = 0x1p-140f; /* its inverse is beyond float32 */
    assert_false(is_taken(&t, &status));
    assert_int_equal(status, STATUS_LIMIT);
    scene_free(&t.scene[0]);
    scene_free(&t.scene[1]);
}

/* u and v, each up to its own error and 2^-20 of that; t by its error beyond the exact ones. */
static void weights_and_distances_are_taken_up_to_their_errors(void **state)
{
    (void)state;
    const float most[2] = {0x1p-10f * (1 + 0x1p-20f), 0x1p-5f * (1 + 0x1p-20f)};
    for (int which = 0; which < 2; which++)
        for (int sign = -1; sign <= 1; sign += 2)
            for (int beyond = 0; beyond < 2; beyond++) {
                struct twin twin = {.u_err = 0x1p-10, .v_err = 0x1p-5};
                struct hit hit = {.t = 1};
                float at = beyond ? nextafterf(most[which], 1) : most[which];
                *(which ? &hit.v : &hit.u) = (float)sign * at;
                assert_int_equal(judge_barycentrics(&twin, &hit), !beyond);
                *(which ? &twin.v_near : &twin.u_near) = (double)sign * 0x1p-24;
                assert_true(judge_barycentrics(&twin, &hit));
                *(which ? &twin.v_near : &twin.u_near) = 1e30;
                assert_false(judge_barycentrics(&twin, &hit));
                *(which ? &twin.v_err : &twin.u_err) = INFINITY;
                assert_true(judge_barycentrics(&twin, &hit));
            }
    assert_true(judge_over(1, 2, 3, 0.5) == 2 && judge_over(3.25, 2, 3, 0.5) == 0.5);
    assert_true(judge_over(2, 2, 3, 0) == 0 && judge_over(3, 2, 3, 0) == 0);
    assert_true(judge_over(2.5, 2, 3, 0) == 0 && judge_over(2.75, 3, 4, 0.25) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_is_that_of_its_formula),
        cmocka_unit_test(what_has_no_area_has_no_plane),
        cmocka_unit_test(coordinates_are_taken_up_to_a_limit),
        cmocka_unit_test(placed_coordinates_are_taken_up_to_the_limit),
        cmocka_unit_test(weights_and_distances_are_taken_up_to_their_errors),
    };
    return cmocka_run_group_tests_name("ray_triangle", tests, NULL, NULL) ? 1 : 0;
}
