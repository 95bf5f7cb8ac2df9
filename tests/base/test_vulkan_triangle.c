/* The triangle tests of the shaders (shaders/tri*.glsl) have C's bits (ref/primitives/tri*.h): of
 * rays that are prepared every member, of each test whether it hits, and then t, u and v, and the
 * transform of stored triangles. Nothing here is subnormal, which a driver may take for 0. */
#include "ref/primitives/test_run.h"
#include "tests/support/adverse.h"
#include "tests/support/triangle_drawn.h"

#include "tests/support/gpu.h"

#define GROUP 128u
#define CASES (160u * GROUP)
#define WORDS 60u /* of a case's answer: the quads of shaders/probes/probe_triangle.comp */
#define TESTS 5u  /* of triangles: ABI_TRI_* */

enum triangle_kind {
    TRIANGLE_PLAIN,
    TRIANGLE_COMPONENTS, /* of the direction: adverse ones */
    TRIANGLE_SCALED,     /* the coordinates, up to 2^39 */
    TRIANGLE_LONG,       /* the direction, up to 2^40 */
    TRIANGLE_THRESHOLD,  /* the determinant is that of mt_rtrs, or beside it */
    TRIANGLE_TOUCHED,    /* the range begins or ends with t, or beside it */
    TRIANGLE_ABSORBED,   /* the origin is so far that all corners are at one place from there */
    TRIANGLE_NO_AREA,    /* or the ray has none to meet */
    TRIANGLE_KINDS,
};

struct triangle_case {
    struct ray ray;
    float v[3][3], eps, t;
};

/* --- inputs ---------------------------------------------------------------------------------- */

/* Corners are whole, and so is the origin; the ray meets a corner, an edge or a point inside. */
static void draw_whole(struct rng *rng, struct triangle_case *c)
{
    static const float weights[][2] = {{0, 0},    {1, 0},       {0, 1},         {0.5f, 0},
                                       {0, 0.5f}, {0.5f, 0.5f}, {0.25f, 0.25f}, {0.25f, 0.5f},
                                       {1.5f, 0}, {-0.5f, 0.5f}};
    const float *w = weights[rng_below(rng, ARRAY_COUNT(weights))];
    for (int k = 0; k < 3; k++) {
        for (int corner = 0; corner < 3; corner++)
            c->v[corner][k] = adverse_whole(rng, 3);
        float to_1 = c->v[1][k] - c->v[0][k], to_2 = c->v[2][k] - c->v[0][k];
        c->ray.org[k] = adverse_whole(rng, 6);
        c->ray.dir[k] = c->v[0][k] + to_1 * w[0] + to_2 * w[1] - c->ray.org[k];
    }
}

/* The direction is any, and the ray as near as before. */
static void turn(struct rng *rng, struct ray *ray)
{
    float at[3];
    for (int k = 0; k < 3; k++)
        at[k] = ray->org[k] + ray->dir[k];
    adverse_direction(rng, 0x1p15f, ray->dir);
    float back = adverse_largest(ray->dir) > 2 ? 0x1p-15f : 1;
    for (int k = 0; k < 3; k++)
        ray->org[k] = at[k] - ray->dir[k] * back;
    adverse_scale(ray->dir, (int)rng_below(rng, 26)); /* up to 2^40 */
}

/* The determinant of e1 = (threshold, 0, 0), e2 = (0, 1, 0) and d = (0, 0, 1), turned and long. */
static void at_threshold(struct rng *rng, struct triangle_case *c)
{
    int x = (int)rng_below(rng, 3), y = (x + 1) % 3, z = (x + 2) % 3, j = (int)rng_below(rng, 61);
    *c = (struct triangle_case){.eps = TRI_RTRS_EPS, .ray.tmax = INFINITY};
    float small = ldexpf(adverse_beside(rng, TRI_RTRS_EPS), -j);
    c->v[1][x] = small * adverse_sign(rng);
    c->v[2][y] = adverse_sign(rng);
    c->ray.dir[z] = ldexpf(adverse_sign(rng), j);
    c->ray.org[z] = -c->ray.dir[z];
    c->ray.org[x] = c->v[1][x] / 4;
    c->ray.org[y] = c->v[2][y] / 4;
}

static void touch(struct rng *rng, struct triangle_case *c)
{
    struct hit hit;
    c->ray.tmin = -INFINITY;
    c->ray.tmax = INFINITY;
    (void)triangle_run(rng_below(rng, TESTS), &c->ray, c->v, &hit);
    float t = adverse_beside(rng, hit.t);
    *(rng_below(rng, 2) ? &c->ray.tmin : &c->ray.tmax) = t;
    c->t = hit.t;
}

/* Sides in a plane of the ray are what is rounded off: their signs may agree, while the determinant
 * is 0. */
static void lose_area(struct rng *rng, struct triangle_case *c)
{
    uint32_t kind = rng_below(rng, 5);
    float part_1 = rng_range(rng, -9, 9), part_2 = rng_range(rng, -9, 9);
    for (int k = 0; k < 3; k++) {
        float to_1 = c->v[1][k] - c->v[0][k], to_2 = c->v[2][k] - c->v[0][k];
        if (kind == 0)
            c->v[1][k] = c->v[0][k];
        else if (kind == 1)
            c->v[2][k] = c->v[1][k] + to_1;
        else if (kind == 2)
            c->ray.dir[k] = 0;
        else {
            c->ray.dir[k] = kind == 3 ? to_1 : to_1 - to_2;
            c->ray.org[k] = c->v[0][k] + to_1 * part_1 + to_2 * part_2;
        }
    }
}

/* Sides are 0, and the determinant is not. */
static void absorb(struct rng *rng, struct triangle_case *c)
{
    float far = 0x1p32f * adverse_sign(rng);
    draw_whole(rng, c);
    for (int k = 0; k < 3; k++) {
        c->ray.dir[k] = adverse_whole(rng, 6);
        c->ray.org[k] = c->ray.dir[k] * far;
    }
}

static void alter(struct rng *rng, enum triangle_kind kind, struct triangle_case *c)
{
    if (kind == TRIANGLE_COMPONENTS)
        turn(rng, &c->ray);
    if (kind == TRIANGLE_SCALED) {
        int e = (int)rng_below(rng, 60) - 20;
        adverse_scale(c->ray.org, e);
        for (int corner = 0; corner < 3; corner++)
            adverse_scale(c->v[corner], e);
    }
    if (kind == TRIANGLE_LONG)
        adverse_scale(c->ray.dir, (int)rng_below(rng, 38));
    if (kind == TRIANGLE_THRESHOLD)
        at_threshold(rng, c);
    if (kind == TRIANGLE_NO_AREA)
        lose_area(rng, c);
    if (kind == TRIANGLE_ABSORBED)
        absorb(rng, c);
    if (kind == TRIANGLE_TOUCHED)
        touch(rng, c);
}

static struct triangle_case triangle_case_draw(struct rng *rng, uint32_t i)
{
    static const float eps[] = {0, 0, TRI_RTRS_EPS, 0.125f}, tmin[] = {0, 0, -0.0f, 0.75f, -1e30f},
                       tmax[] = {INFINITY, INFINITY, 1e30f, 1, 2.5f};
    struct triangle_case c = {0};
    if (rng_below(rng, 2))
        draw_whole(rng, &c);
    else
        triangle_drawn(rng, &c.ray, c.v);
    c.eps = eps[rng_below(rng, ARRAY_COUNT(eps))];
    c.ray.tmin = tmin[rng_below(rng, ARRAY_COUNT(tmin))];
    c.ray.tmax = tmax[rng_below(rng, ARRAY_COUNT(tmax))];
    alter(rng, i % TRIANGLE_KINDS, &c);
    float at[] = {c.ray.tmin, c.ray.tmax, c.t};
    c.t = adverse_beside(rng, at[rng_below(rng, ARRAY_COUNT(at))]);
    return c;
}

/* --- what C has ------------------------------------------------------------------------------ */

static const char *const quad_names[WORDS / 4] = {"o, -",
                                                  "d, tmin",
                                                  "shear, tmax",
                                                  "axes, ids whose range has t",
                                                  "mt_rtrs: hit, t, u, v",
                                                  "mt: hit, t, u, v",
                                                  "woop: hit, t, u, v",
                                                  "pluecker: hit, t, u, v",
                                                  "baldwin_webber: hit, t, u, v",
                                                  "mt by its edges: hit, t, u, v",
                                                  "baldwin_webber by its map: hit, t, u, v",
                                                  "map of u, axis",
                                                  "map of v, -",
                                                  "map of the height, -",
                                                  "woop in any range: hit, t, u, v"};

static void ray_in_c(const struct tri_ray *r, uint32_t want[WORDS])
{
    const float shear[] = {r->sx, r->sy, r->sz};
    for (int k = 0; k < 3; k++) {
        want[k] = float_bits(r->o[k]);
        want[4 + k] = float_bits(r->d[k]);
        want[8 + k] = float_bits(shear[k]);
    }
    want[3] = 0;
    want[7] = float_bits(r->tmin);
    want[11] = float_bits(r->tmax);
    want[12] = (uint32_t)r->kx;
    want[13] = (uint32_t)r->ky;
    want[14] = (uint32_t)r->kz;
}

/* Of a miss the numbers are undefined; the shader writes zeros. */
static void put_hit(uint32_t quad[4], bool hit, const struct hit *h)
{
    quad[0] = hit;
    quad[1] = hit ? float_bits(h->t) : 0;
    quad[2] = hit ? float_bits(h->u) : 0;
    quad[3] = hit ? float_bits(h->v) : 0;
}

static void hits_in_c(const struct triangle_case *c, const struct tri_ray *r, uint32_t want[WORDS])
{
    struct hit hit;
    float v[3][3], m[9], e1[3], e2[3];
    memcpy(v, c->v, sizeof v);
    for (int k = 0; k < 3; k++) {
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
    }
    for (uint32_t id = 0; id < TESTS; id++) {
        want[15] |= (uint32_t)tri_in_range(id, r, c->t) << id;
        bool met = tri_test_run(id, r, v, &hit);
        put_hit(&want[16 + 4 * id], met, &hit);
    }
    bool met = tri_moeller_trumbore_edges(r, v[0], e1, e2, c->eps, &hit);
    put_hit(&want[36], met, &hit);
    int axis = baldwin_webber_transform(v, m);
    met = baldwin_webber_hit(r, m, axis, &hit);
    put_hit(&want[40], met, &hit);
    met = tri_woop(r, v, &hit);
    put_hit(&want[56], met, &hit);
    want[47] = (uint32_t)axis;
    for (uint32_t k = 0; k < 9; k++)
        want[44 + 4 * (k / 3) + k % 3] = float_bits(m[k]);
}

/* --- the comparison -------------------------------------------------------------------------- */

struct triangle_inputs {
    struct ray ray[CASES];
    float quads[CASES][3][4];
    struct triangle_case of[CASES];
    uint32_t got[CASES][WORDS];
};

static struct triangle_inputs *inputs_make(void)
{
    struct triangle_inputs *in = calloc(1, sizeof *in);
    struct rng rng = rng_make(40, 0);
    assert_non_null(in);
    for (uint32_t i = 0; i < CASES; i++) {
        const struct triangle_case c = triangle_case_draw(&rng, i);
        in->of[i] = c;
        in->ray[i] = c.ray;
        for (int corner = 0; corner < 3; corner++)
            memcpy(in->quads[i][corner], c.v[corner], sizeof c.v[corner]);
        in->quads[i][0][3] = c.eps;
        in->quads[i][1][3] = c.t;
    }
    return in;
}

static void compare(const struct triangle_inputs *in, uint32_t i, const char *driver,
                    uint32_t hits[TESTS])
{
    const struct tri_ray r = tri_ray_make(&in->of[i].ray);
    uint32_t want[WORDS] = {0};
    ray_in_c(&r, want);
    hits_in_c(&in->of[i], &r, want);
    for (uint32_t id = 0; id < TESTS; id++)
        hits[id] += want[16 + 4 * id];
    for (uint32_t w = 0; w < WORDS; w++)
        if (!adverse_same(in->got[i][w], want[w]))
            fail_msg("%s: case %u of kind %u: %s: number %u is %08x (%a), not %08x (%a)", driver, i,
                     i % TRIANGLE_KINDS, quad_names[w / 4], w % 4, in->got[i][w],
                     (double)float_from_bits(in->got[i][w]), want[w],
                     (double)float_from_bits(want[w]));
}

static void run(struct vk *vk, const char *driver, void *of)
{
    struct triangle_inputs *in = of;
    const uint32_t constant[] = {GROUP, ABI_BOX_ROBUST, ABI_TRI_MT, 0, 16};
    const struct push push = {.ray_count = CASES};
    uint32_t none[4] = {0}, hits[TESTS] = {0};
    memset(in->got, 0, sizeof in->got);
    gpu_run_on(vk, "probe_triangle", constant, ARRAY_COUNT(constant), &push, sizeof push,
               CASES / GROUP, 6,
               (const uint64_t[]){sizeof in->ray, sizeof in->got, 16, 16, 16, sizeof in->quads},
               (void *const[]){in->ray, in->got, none, none, none, in->quads});
    for (uint32_t i = 0; i < CASES; i++)
        compare(in, i, driver, hits);
    for (uint32_t id = 0; id < TESTS; id++)
        assert_true(hits[id] > CASES / 8 && hits[id] < CASES - CASES / 4);
}

static void rays_are_prepared_and_triangles_hit_as_in_c(void **state)
{
    (void)state;
    struct triangle_inputs *in = inputs_make();
    bool any = gpu_on_cpu_drivers(run, in);
    free(in);
    if (!any)
        skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_prepared_and_triangles_hit_as_in_c),
    };
    return cmocka_run_group_tests_name("vulkan_triangle", tests, NULL, NULL) ? 1 : 0;
}
