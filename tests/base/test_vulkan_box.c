/* The box tests of the shaders (shaders/slab.glsl) have C's bits (ref/primitives/slab.h): of rays
 * that are prepared every member, of boxes the hit and the entry. Nothing here is subnormal, which
 * a driver may take for 0. */
#include "ref/primitives/test_run.h"
#include "tests/support/adverse.h"

#include "tests/support/gpu.h"

#include <float.h>

#define GROUP 128u
#define CASES (96u * GROUP)
#define WORDS 40u /* of a case's answer: the quads of shaders/probes/probe_box.comp */
#define AWAY  3e38f

enum box_kind {
    BOX_PLAIN,
    BOX_COMPONENTS, /* of the direction: adverse ones */
    BOX_BORDER,     /* of parallel: a component at 2^-60 of the largest, or beside it */
    BOX_ON_PLANE,   /* parallel to an axis, in a plane of the box or beside it */
    BOX_TOUCHED,    /* the range ends or begins where the box does, or beside it */
    BOX_FAR_AWAY,   /* planes at a t beyond what rtrs takes for infinite */
    BOX_LONG,       /* the direction, up to 2^100 */
    BOX_FLAT,       /* in x, and as far as rtrs loses it */
    BOX_EMPTY,      /* a slot without a child: from the largest number to the least */
    BOX_KINDS,
};

struct box_case {
    struct ray ray;
    struct box box, scene;
    float by;
};

/* --- inputs ---------------------------------------------------------------------------------- */

static void draw_whole(struct rng *rng, struct box_case *c)
{
    for (int k = 0; k < 3; k++) {
        c->box.lo[k] = adverse_whole(rng, 3);
        c->box.hi[k] = c->box.lo[k] + (float)rng_below(rng, 4);
        c->scene.lo[k] = adverse_whole(rng, 9);
        c->scene.hi[k] = c->scene.lo[k] + (float)rng_below(rng, 9);
        c->ray.org[k] = adverse_whole(rng, 6);
        float at[] = {c->box.lo[k], c->box.hi[k], (c->box.lo[k] + c->box.hi[k]) / 2, 2};
        c->ray.dir[k] = at[rng_below(rng, ARRAY_COUNT(at))] - c->ray.org[k];
    }
}

static void draw_any(struct rng *rng, struct box_case *c)
{
    for (int k = 0; k < 3; k++) {
        c->box.lo[k] = rng_range(rng, -4, 4);
        c->box.hi[k] = c->box.lo[k] + rng_range(rng, 0, 4);
        c->scene.lo[k] = rng_range(rng, -9, 5);
        c->scene.hi[k] = c->scene.lo[k] + rng_range(rng, 0, 9);
        c->ray.org[k] = rng_range(rng, -8, 8);
        float part = rng_range(rng, -0.1f, 1.1f);
        c->ray.dir[k] = c->box.lo[k] + (c->box.hi[k] - c->box.lo[k]) * part - c->ray.org[k];
    }
}

static struct slab_ray prepared(const struct box_case *c)
{
    struct slab_ray r = slab_ray_make(&c->ray);
    slab_ray_widen(&r, c->by);
    slab_ray_place(&r, &c->scene);
    return r;
}

/* The range ends at the entry of either test, or begins where the ray leaves an axis' planes. */
static void touch(struct rng *rng, struct box_case *c)
{
    struct slab_ray r = prepared(c);
    uint32_t kind = rng_below(rng, 4), k = rng_below(rng, 3);
    float entry, side = r.d[k] < 0 ? c->box.lo[k] : c->box.hi[k];
    float leaves = (side - r.far[k]) * r.inv[k];
    if (kind < 2) {
        (void)box_test_run(kind ? ABI_BOX_ROBUST : ABI_BOX_WATERTIGHT, &r, &c->box, c->ray.tmax,
                           &entry);
        c->ray.tmax = adverse_beside(rng, entry);
    } else {
        c->ray.tmin = adverse_beside(rng, kind == 2 ? leaves * SLAB_FAR : leaves / SLAB_NEAR);
    }
}

static void on_plane(struct rng *rng, struct box_case *c)
{
    int k = (int)rng_below(rng, 3);
    float side = rng_below(rng, 2) ? c->box.lo[k] - c->by : c->box.hi[k] + c->by;
    c->ray.dir[k] = 0.0f * adverse_sign(rng);
    c->ray.org[k] = adverse_beside(rng, side);
    if (side == 0)
        c->ray.org[k] = 0.0f * adverse_sign(rng);
}

static void empty(struct box *box)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = FLT_MAX;
        box->hi[k] = -FLT_MAX;
    }
}

static void alter(struct rng *rng, enum box_kind kind, struct box_case *c)
{
    uint32_t k = rng_below(rng, 3);
    if (kind == BOX_COMPONENTS)
        adverse_direction(rng, rng_below(rng, 2) ? 0x1p40f : 0x1p20f, c->ray.dir);
    if (kind == BOX_BORDER) {
        float border = 0x1p-60f * adverse_largest(c->ray.dir);
        border = border > 0 ? adverse_beside(rng, border) : 0;
        c->ray.dir[k] = border * adverse_sign(rng);
    }
    if (kind == BOX_ON_PLANE)
        on_plane(rng, c);
    if (kind == BOX_FAR_AWAY)
        for (int axis = 0; axis < 3; axis++)
            c->ray.dir[axis] *= rng_below(rng, 3) ? 0x1p-50f : 1;
    if (kind == BOX_LONG)
        adverse_scale(c->ray.dir, (int)rng_below(rng, 98));
    if (kind == BOX_FLAT)
        c->box.lo[0] = c->box.hi[0] = ldexpf(c->box.lo[0], (int)rng_below(rng, 10));
    if (kind == BOX_EMPTY)
        empty(&c->box);
    if (kind == BOX_TOUCHED)
        touch(rng, c);
}

static struct box_case box_case_draw(struct rng *rng, uint32_t i)
{
    static const float by[] = {0, 0, 0x1p-10f, 0.5f, 1}, tmin[] = {0, 0, -0.0f, 0.75f, -1e30f},
                       tmax[] = {INFINITY, INFINITY, 1e30f, 1, 2.5f};
    const enum box_kind kind = i % BOX_KINDS;
    struct box_case c = {0};
    c.by = by[rng_below(rng, ARRAY_COUNT(by))];
    c.ray.tmin = tmin[rng_below(rng, ARRAY_COUNT(tmin))];
    c.ray.tmax = tmax[rng_below(rng, ARRAY_COUNT(tmax))];
    if (kind == BOX_LONG || rng_below(rng, 2))
        draw_whole(rng, &c);
    else
        draw_any(rng, &c);
    alter(rng, kind, &c);
    return c;
}

/* --- what C has ------------------------------------------------------------------------------ */

static const char *const quad_names[WORDS / 4] = {"o, main",
                                                  "d, behind",
                                                  "inv, tmin",
                                                  "o_near, swapped",
                                                  "o_far, hits",
                                                  "pad, entry of the test",
                                                  "at_most, entry of robust",
                                                  "at_least, entry of watertight",
                                                  "near planes, entry of rtrs",
                                                  "far planes, behind before placed"};

/* In the shader planes of parallel axes are far away and are compared with at_most, at_least. */
static void ray_in_c(const struct slab_ray *r, const struct box *box, bool ordered,
                     uint32_t want[WORDS])
{
    for (int k = 0; k < 3; k++) {
        const bool parallel = r->parallel[k], down = ordered && r->d[k] < 0 && !parallel;
        want[k] = float_bits(r->o[k]);
        want[4 + k] = float_bits(r->d[k]);
        want[8 + k] = float_bits(parallel ? 1 : r->inv[k]);
        want[12 + k] = float_bits(parallel ? AWAY : r->near[k]);
        want[16 + k] = float_bits(parallel ? -AWAY : r->far[k]);
        want[20 + k] = float_bits(parallel ? 4 : SLAB_FAR);
        want[24 + k] = float_bits(parallel ? r->near[k] : INFINITY);
        want[28 + k] = float_bits(parallel ? r->far[k] : -INFINITY);
        want[32 + k] = float_bits(down ? box->hi[k] : box->lo[k]);
        want[36 + k] = float_bits(down ? box->lo[k] : box->hi[k]);
        want[15] |= (uint32_t)down << k;
    }
    want[3] = (uint32_t)r->main;
    want[7] = float_bits(r->behind);
    want[11] = float_bits(r->tmin);
}

/* Returns bits of tests that hit, in the shader's order; the first is the pipeline's. */
static uint32_t hits_in_c(const struct box_case *c, const struct slab_ray *r, uint32_t id,
                          uint32_t want[WORDS])
{
    float chosen, robust, watertight, rtrs;
    uint32_t hits = box_test_run(id, r, &c->box, c->ray.tmax, &chosen);
    hits |= (uint32_t)slab_robust(r, &c->box, c->ray.tmax, &robust) << 1;
    hits |= (uint32_t)slab_watertight(r, &c->box, c->ray.tmax, &watertight) << 2;
    hits |= (uint32_t)slab_rtrs(r, &c->box, &rtrs) << 3;
    want[19] = hits;
    want[23] = float_bits(chosen);
    want[27] = float_bits(robust);
    want[31] = float_bits(watertight);
    want[35] = float_bits(rtrs);
    return hits;
}

/* Of a box that is missed no entry is read. For rtrs rays are not ordered, and neither widened nor
 * placed by this order: what it does not read is left out. So is how far the scene extends behind a
 * ray without a direction. */
static void left_out(uint32_t id, const struct slab_ray *r, const uint32_t got[WORDS],
                     uint32_t want[WORDS])
{
    static const uint32_t ordered[] = {7, 12, 13, 14, 16, 17, 18, 24, 25, 26, 27, 28, 29, 30, 31};
    if (id == ABI_BOX_RTRS) {
        for (size_t i = 0; i < ARRAY_COUNT(ordered); i++)
            want[ordered[i]] = got[ordered[i]];
        want[19] = (want[19] & 9) | (got[19] & 6);
    }
    for (uint32_t test = 0; test < 4; test++)
        if (!(want[19] >> test & 1))
            want[23 + 4 * test] = got[23 + 4 * test];
    if (adverse_largest(r->d) == 0) {
        want[7] = got[7];
        want[31] = got[31];
        want[23] = id == ABI_BOX_WATERTIGHT ? got[23] : want[23];
    }
}

/* --- the comparison -------------------------------------------------------------------------- */

struct box_inputs {
    struct ray ray[CASES];
    float quads[CASES][4][4];
    struct box_case of[CASES];
    uint32_t got[CASES][WORDS];
};

static void put(float quad[4], const float v[3], float last)
{
    memcpy(quad, v, 3 * sizeof *v);
    quad[3] = last;
}

static struct box_inputs *inputs_make(void)
{
    struct box_inputs *in = calloc(1, sizeof *in);
    struct rng rng = rng_make(151, 160);
    assert_non_null(in);
    for (uint32_t i = 0; i < CASES; i++) {
        in->of[i] = box_case_draw(&rng, i);
        in->ray[i] = in->of[i].ray;
        put(in->quads[i][0], in->of[i].box.lo, in->of[i].by);
        put(in->quads[i][1], in->of[i].box.hi, 0);
        put(in->quads[i][2], in->of[i].scene.lo, 0);
        put(in->quads[i][3], in->of[i].scene.hi, 0);
    }
    return in;
}

static void compare(const struct box_inputs *in, uint32_t i, const char *driver, uint32_t id,
                    uint32_t hits[4])
{
    const struct box_case *c = &in->of[i];
    const struct slab_ray r = prepared(c);
    uint32_t want[WORDS] = {0};
    ray_in_c(&r, &c->box, id != ABI_BOX_RTRS, want);
    want[39] = float_bits(slab_ray_make(&c->ray).behind);
    uint32_t hit = hits_in_c(c, &r, id, want);
    left_out(id, &r, in->got[i], want);
    for (uint32_t k = 0; k < 4; k++)
        hits[k] += hit >> k & 1;
    for (uint32_t w = 0; w < WORDS; w++)
        if (!adverse_same(in->got[i][w], want[w]))
            fail_msg("%s: case %u of kind %u, test %u: %s: number %u is %08x (%a), not %08x (%a)",
                     driver, i, i % BOX_KINDS, id, quad_names[w / 4], w % 4, in->got[i][w],
                     (double)float_from_bits(in->got[i][w]), want[w],
                     (double)float_from_bits(want[w]));
}

static void run(struct vk *vk, const char *driver, uint32_t id, struct box_inputs *in)
{
    const uint32_t constant[] = {GROUP, id, ABI_TRI_MT, 0, 16};
    const struct push push = {.ray_count = CASES};
    uint32_t none[4] = {0}, hits[4] = {0};
    memset(in->got, 0, sizeof in->got);
    gpu_run_on(vk, "probe_box", constant, ARRAY_COUNT(constant), &push, sizeof push, CASES / GROUP,
               6, (const uint64_t[]){sizeof in->ray, sizeof in->got, 16, 16, 16, sizeof in->quads},
               (void *const[]){in->ray, in->got, none, none, none, in->quads});
    for (uint32_t i = 0; i < CASES; i++)
        compare(in, i, driver, id, hits);
    for (uint32_t k = 0; k < 4; k++)
        assert_true(hits[k] > CASES / 4 && hits[k] < CASES - CASES / 16);
}

static void run_each(struct vk *vk, const char *driver, void *of)
{
    static const uint32_t ids[] = {ABI_BOX_RTRS, ABI_BOX_ROBUST, ABI_BOX_WATERTIGHT};
    for (size_t i = 0; i < ARRAY_COUNT(ids); i++)
        run(vk, driver, ids[i], of);
}

static void rays_are_prepared_and_boxes_met_as_in_c(void **state)
{
    (void)state;
    struct box_inputs *in = inputs_make();
    bool any = gpu_on_cpu_drivers(run_each, in);
    free(in);
    if (!any)
        skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_prepared_and_boxes_met_as_in_c),
    };
    return cmocka_run_group_tests_name("vulkan_box", tests, NULL, NULL) ? 1 : 0;
}
