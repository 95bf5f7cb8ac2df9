/* Laws of ref/primitives/slab.h: the repaired tests against exact arithmetic, the published test as
 * it is. */
#include "ref/primitives/primitives.h"
#include "ref/base/rng.h"
#include "ref/primitives/test_run.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#define TMAX 1e30f

/* --- exact arithmetic ------------------------------------------------------------------------ */

/* Coordinates in units of 2^-48 below 2^8, directions in 2^-40 below 2^4, t in 2^-40 below 2^20:
 * then every product below fits 127 bits. */
static __int128 fixed(float x, int bits)
{
    double scaled = ldexp((double)x, bits);
    assert_true(scaled == rint(scaled) && fabs(scaled) < 0x1p62);
    return (__int128)(int64_t)scaled;
}

/* t = n / q, q > 0, in units of 2^-8. */
struct boxes_ratio {
    __int128 n, q;
};

static struct boxes_ratio crossing(float plane, float org, float dir)
{
    struct boxes_ratio t = {fixed(plane, 48) - fixed(org, 48), fixed(dir, 40)};
    if (t.q < 0)
        t = (struct boxes_ratio){-t.n, -t.q};
    return t;
}

static bool at_most(struct boxes_ratio a, struct boxes_ratio b)
{
    return a.n * b.q <= b.n * a.q;
}

/* t as 2^40 t / 2^40, so that its units are those of crossing. */
static struct boxes_ratio ratio_of(float t)
{
    return (struct boxes_ratio){fixed(t, 40), (__int128)1 << 32};
}

/* Where the exact ray is inside the slabs of all axes, if it is anywhere. */
struct boxes_exact {
    bool outside; /* of the slab of an axis that it is parallel to */
    int count;
    struct boxes_ratio near[3], far[3];
};

static struct boxes_exact exact_make(const struct ray *ray, const struct box *box)
{
    struct boxes_exact e = {0};
    for (int k = 0; k < 3; k++) {
        float d = ray->dir[k];
        if (d == 0) {
            e.outside |= ray->org[k] < box->lo[k] || ray->org[k] > box->hi[k];
            continue;
        }
        e.near[e.count] = crossing(d < 0 ? box->hi[k] : box->lo[k], ray->org[k], d);
        e.far[e.count++] = crossing(d < 0 ? box->lo[k] : box->hi[k], ray->org[k], d);
    }
    return e;
}

static bool exact_meets(const struct ray *ray, const struct box *box)
{
    struct boxes_exact e = exact_make(ray, box);
    for (int i = 0; i < e.count; i++) {
        for (int j = 0; j < e.count; j++)
            if (!at_most(e.near[i], e.far[j]))
                return false;
        if (!at_most(ratio_of(ray->tmin), e.far[i]))
            return false;
        if (ray->tmax != TMAX && !at_most(e.near[i], ratio_of(ray->tmax)))
            return false;
    }
    return !e.outside;
}

static double as_double(struct boxes_ratio t)
{
    return ldexp((double)t.n / (double)t.q, -8);
}

/* Is the box missed by more than one part in 2^16? */
static bool clearly_missed(const struct ray *ray, const struct box *box)
{
    struct boxes_exact e = exact_make(ray, box);
    double near = (double)ray->tmin, far = (double)ray->tmax;
    for (int i = 0; i < e.count; i++) {
        near = fmax(near, as_double(e.near[i]));
        far = fmin(far, as_double(e.far[i]));
    }
    return e.outside || far < 0 || near > far * (1 + 0x1p-16);
}

/* The robust test's verdict without its padding, from the definition. */
static bool unpadded_accepts(const struct ray *ray, const struct box *box, float padding)
{
    float near = ray->tmin, far = ray->tmax;
    for (int k = 0; k < 3; k++) {
        if (ray->dir[k] == 0)
            continue;
        float inv = 1 / ray->dir[k];
        float a = (box->lo[k] - ray->org[k]) * inv, b = (box->hi[k] - ray->org[k]) * inv;
        near = fmaxf(near, fminf(a, b));
        far = fminf(far, fmaxf(a, b) * padding);
    }
    return near <= far;
}

/* --- a sample that is hard on box tests ------------------------------------------------------ */

enum sample { RANDOM, FLAT, CORNER, LATTICE, ON_A_FACE, RANGE_END, SAMPLE_COUNT };

static float zero(struct rng *rng)
{
    return rng_below(rng, 2) ? 0.0f : -0.0f;
}

/* A float of random sign and exponent within 2^-12 .. 2^3, so that fixed() holds it. */
static float spread(struct rng *rng)
{
    float x = rng_scaled(rng, 1, 2, -12, 15);
    return rng_below(rng, 2) ? x : -x;
}

static void sort(struct box *box)
{
    for (int k = 0; k < 3; k++)
        if (box->lo[k] > box->hi[k]) {
            float x = box->lo[k];
            box->lo[k] = box->hi[k];
            box->hi[k] = x;
        }
}

static void lattice_sample(struct rng *rng, struct ray *ray, struct box *box)
{
    for (int k = 0; k < 3; k++) {
        ray->org[k] = (float)rng_below(rng, 9) - 4;
        ray->dir[k] = (float)rng_below(rng, 5) - 2;
        box->lo[k] = (float)rng_below(rng, 9) - 4;
        box->hi[k] = (float)rng_below(rng, 9) - 4;
        if (ray->dir[k] == 0)
            ray->dir[k] = zero(rng);
    }
    if (ray->dir[0] == 0 && ray->dir[1] == 0 && ray->dir[2] == 0)
        ray->dir[rng_below(rng, 3)] = 1;
    sort(box);
}

/* A corner, edge or face of the box lies at about the same t on every axis. */
static void corner_sample(struct rng *rng, struct ray *ray, struct box *box)
{
    float t = rng_scaled(rng, 1, 2, -2, 4);
    for (int k = 0; k < 3; k++) {
        ray->dir[k] = rng_scaled(rng, 1, 2, -1, 2);
        ray->org[k] = rng_scaled(rng, -0.5f, 0.5f, -19, 20);
        ray->org[k] = rintf(ray->org[k] * 0x1p40f) * 0x1p-40f;
        bool enters = rng_below(rng, 2);
        float at = (float)((double)ray->org[k] + (double)t * (double)ray->dir[k]);
        (enters ? box->lo : box->hi)[k] = at;
        (enters ? box->hi : box->lo)[k] = enters ? at + 1 : at - 1;
        if (rng_below(rng, 2)) { /* mirror the axis */
            float lo = box->lo[k];
            ray->dir[k] = -ray->dir[k];
            ray->org[k] = -ray->org[k];
            box->lo[k] = -box->hi[k];
            box->hi[k] = -lo;
        }
    }
}

static void draw(struct rng *rng, enum sample kind, struct ray *ray, struct box *box)
{
    *ray = (struct ray){.tmin = 0, .tmax = TMAX};
    for (int k = 0; k < 3; k++) {
        ray->org[k] = spread(rng);
        ray->dir[k] = spread(rng);
        box->lo[k] = spread(rng);
        box->hi[k] = spread(rng);
        if (kind == FLAT && rng_below(rng, 2))
            box->hi[k] = box->lo[k];
    }
    sort(box);
    if (rng_below(rng, 2)) /* aimed into the box */
        for (int k = 0; k < 3; k++) {
            float at = rintf(rng_range(rng, box->lo[k], box->hi[k]) * 0x1p30f) * 0x1p-30f;
            ray->dir[k] = at - ray->org[k];
        }
    if (kind == CORNER)
        corner_sample(rng, ray, box);
    if (kind == LATTICE || kind == RANGE_END)
        lattice_sample(rng, ray, box);
    if (kind == ON_A_FACE) {
        uint32_t k = rng_below(rng, 3);
        ray->org[k] = rng_below(rng, 2) ? box->lo[k] : box->hi[k];
        ray->dir[k] = rng_below(rng, 2) ? zero(rng) : ray->dir[k];
    }
    if (kind == RANGE_END) { /* t of lattice planes, exactly */
        ray->tmin = (float)rng_below(rng, 4);
        ray->tmax = ray->tmin + (float)rng_below(rng, 4);
    }
}

#define SAMPLES 200000

static void repaired_tests_accept_whatever_the_exact_ray_meets(void **state)
{
    (void)state;
    for (int kind = 0; kind < SAMPLE_COUNT; kind++) {
        struct rng rng = rng_make(3, (uint64_t)kind);
        uint32_t met = 0, missed = 0, padded = 0;
        for (int i = 0; i < SAMPLES; i++) {
            struct ray ray;
            struct box box;
            float entry = -1;
            draw(&rng, (enum sample)kind, &ray, &box);
            struct slab_ray r = slab_ray_make(&ray);
            bool hit = slab_robust(&r, &box, ray.tmax, &entry);
            if (hit)
                assert_true(entry >= ray.tmin);
            slab_ray_place(&r, &box);
            bool wide = slab_watertight(&r, &box, ray.tmax, &entry);
            if (exact_meets(&ray, &box))
                assert_true(wide);
            if (exact_meets(&ray, &box)) {
                if (!hit)
                    fail_msg("kind %d: o %a %a %a d %a %a %a lo %a %a %a hi %a %a %a", kind,
                             (double)ray.org[0], (double)ray.org[1], (double)ray.org[2],
                             (double)ray.dir[0], (double)ray.dir[1], (double)ray.dir[2],
                             (double)box.lo[0], (double)box.lo[1], (double)box.lo[2],
                             (double)box.hi[0], (double)box.hi[1], (double)box.hi[2]);
                met++;
                padded += !unpadded_accepts(&ray, &box, 1);
            } else if (clearly_missed(&ray, &box)) {
                assert_false(hit);
                missed++;
            }
        }
        assert_true(met > SAMPLES / 50); /* not vacuous */
        assert_true(kind == CORNER || missed > SAMPLES / 50);
        if (kind == CORNER)
            assert_true(padded > met / 1000); /* the sample is hard */
    }
}

/* numerics of the widely copied factor 1 + 4u: at this corner it is not enough. */
static void robust_keeps_the_corner_that_a_padding_of_4u_loses(void **state)
{
    (void)state;
    struct ray ray = {{0x1.fab78p-24f, -0x1.fc6fe8p-24f, 0}, 0, {0x1.da2p+0f, 0x1.da7ap+0f, 0}, 64};
    struct box box = {{0x1.00fb64p+1f, -8, -1}, {8, 0x1.012c2ap+1f, 1}};
    struct slab_ray r = slab_ray_make(&ray);
    float entry;
    assert_true(exact_meets(&ray, &box));
    assert_false(unpadded_accepts(&ray, &box, 1));
    assert_false(unpadded_accepts(&ray, &box, 1.00000024f));
    assert_true(unpadded_accepts(&ray, &box, 1.00000036f));
    assert_true(slab_robust(&r, &box, 64, &entry));
    assert_true(entry == 0x1.1582c2p0f);
    for (int k = 0; k < 2; k++) { /* mirrored */
        ray.org[k] = -ray.org[k];
        ray.dir[k] = -ray.dir[k];
        float lo = box.lo[k];
        box.lo[k] = -box.hi[k];
        box.hi[k] = -lo;
        r = slab_ray_make(&ray);
        assert_true(slab_robust(&r, &box, 64, &entry));
    }
}

static bool robust(struct ray ray, struct box box)
{
    struct slab_ray r = slab_ray_make(&ray);
    float entry;
    return slab_robust(&r, &box, ray.tmax, &entry);
}

static void robust_is_closed_in_every_direction(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            float s = (float)sign, above = nextafterf(2, 3), below = nextafterf(1, 0);
            struct box box = {{1, 1, 1}, {2, 2, 2}};
            struct ray ray = {{1.5f, 1.5f, 1.5f}, 0, {0, 0, 0}, TMAX};
            int other = (k + 1) % 3;
            ray.dir[k] = s;
            for (int z = 0; z < 2; z++) { /* parallel to the others, with either zero */
                ray.dir[other] = ray.dir[(k + 2) % 3] = z ? -0.0f : 0.0f;
                for (int face = 1; face <= 2; face++) {
                    ray.org[other] = (float)face;
                    assert_true(robust(ray, box));
                }
                ray.org[other] = above;
                assert_false(robust(ray, box));
                ray.org[other] = below;
                assert_false(robust(ray, box));
                ray.org[other] = 1.5f;
            }
            ray.org[k] = s > 0 ? 2 : 1; /* on the face it leaves by */
            assert_true(robust(ray, box));
            ray.org[k] = s > 0 ? above : below;
            assert_false(robust(ray, box));
            ray.org[k] = s > 0 ? -1 : 4; /* t from 2 to 3 */
            ray.tmin = 3;
            assert_true(robust(ray, box));
            ray.tmin = 3.0001f;
            assert_false(robust(ray, box));
            ray.tmin = 0;
            ray.tmax = 2;
            assert_true(robust(ray, box));
            ray.tmax = nextafterf(2, 0);
            assert_false(robust(ray, box));
        }
}

static void robust_takes_components_below_2_60_for_parallel(void **state)
{
    (void)state;
    struct ray ray = {{0, 0, 0}, 0, {3, 3 * 0x1p-60f, -3 * 0x1p-61f}, 1};
    struct slab_ray r = slab_ray_make(&ray);
    assert_false(r.parallel[0] || r.parallel[1]);
    assert_true(r.parallel[2] && r.inv[2] == 0);
    struct ray nothing = {{0, 0, 0}, 0, {0, -0.0f, NAN}, 1};
    r = slab_ray_make(&nothing);
    assert_true(r.parallel[0] && r.parallel[1] && r.parallel[2]);
}

/* What x gives is all that counts, F1; flat in x and farther than 64 is nothing, F14. */
static void rtrs_is_a_test_of_x_alone(void **state)
{
    (void)state;
    struct rng rng = rng_make(8, 0);
    for (int i = 0; i < SAMPLES; i++) {
        struct ray ray;
        struct box box;
        float entry, x[2];
        draw(&rng, i % 2 ? RANDOM : FLAT, &ray, &box);
        struct slab_ray r = slab_ray_make(&ray);
        x[0] = (box.lo[0] - SLAB_RTRS_EPS - ray.org[0]) / ray.dir[0];
        x[1] = (box.hi[0] + SLAB_RTRS_EPS - ray.org[0]) / ray.dir[0];
        assert_int_equal(slab_rtrs(&r, &box, &entry), x[0] != x[1]);
        assert_true(entry == fminf(x[0], x[1]));
    }
    struct ray across = {{0, 0, 0}, 0, {-1, 0, 0}, TMAX};
    struct slab_ray r = slab_ray_make(&across);
    float entry;
    assert_true(slab_rtrs(&r, &(struct box){{-64, 5, 5}, {-64, 6, 6}}, &entry));
    assert_false(slab_rtrs(&r, &(struct box){{-100, -9, -9}, {-100, 9, 9}}, &entry));
    assert_true(slab_robust(&r, &(struct box){{-100, -9, -9}, {-100, 9, 9}}, TMAX, &entry));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(repaired_tests_accept_whatever_the_exact_ray_meets),
        cmocka_unit_test(robust_keeps_the_corner_that_a_padding_of_4u_loses),
        cmocka_unit_test(robust_is_closed_in_every_direction),
        cmocka_unit_test(robust_takes_components_below_2_60_for_parallel),
        cmocka_unit_test(rtrs_is_a_test_of_x_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
