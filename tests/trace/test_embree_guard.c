/* Rays that Embree aborts on are not given to it, nor to instances that would lengthen them too
 * much: what is computed here from the header of ref/engines/embree_worlds.c is compared with the
 * masks that arrive at Embree, a millionth beside each border. */
#include "ref/engine.h"

#include <stdio.h>

#include "tests/support/world_laws.h"

#if HAVE_EMBREE

#include "tests/support/embree_calls.h"

#include "ref/base/rng.h"

#define CLASSES 4
#define MOST    ((double)1e18f) /* no coordinate of a ray reaches it, in any space */

struct class_of {
    double growth, far;
};

static const struct engine *engine;

static void *opened(bool unguarded, bool without_masks)
{
    const struct engine_options options = {.threads = 1, .device = -1, .unguarded = unguarded};
    struct reason reason = {""};
    void *self = NULL;
    calls_forget();
    calls.no_ray_masks = without_masks;
    engine = engine_find("embree");
    if (engine_open(engine, &options, &self, &reason))
        fail_msg("%s", reason.text);
    return self;
}

static void miss(embree_context *context, struct RTCRayHit *query)
{
    (void)context, (void)query;
}

static enum status prepared(void *self, const struct world *world, enum query query,
                            struct reason *reason)
{
    const struct world_job job = {
        .world = world, .box = box_tests[0], .tri = tri_tests[0], .query = query};
    calls.masks = 0;
    return engine->worlds->prepare_world(self, &job, reason);
}

/* One product of three numbers of a determinant, by a permutation of columns. */
static const int permutation[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                      {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};

/* How many times as long Embree's inverse can make a ray; 0: any. */
static double growth_of(const struct instance *at)
{
    long double det = 0, size = 0, most = 0, largest = 1;
    for (int p = 0; p < 6; p++) {
        long double term = p < 3 ? 1 : -1;
        for (int row = 0; row < 3; row++)
            term *= (long double)at->m[row][permutation[p][row]];
        det += term;
        size += fabsl(term);
    }
    /* Column i without row j: the row of the inverse is that of the column. */
    for (int i = 0; i < 3; i++) {
        long double sum = 0;
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                if (a != b) /* rows; the columns are the two that are not i */
                    sum += fabsl((long double)at->m[a][(i + 1) % 3] *
                                 (long double)at->m[b][(i + 2) % 3]);
        most = sum > most ? sum : most;
        for (int j = 0; j < 3; j++)
            largest = fmaxl(largest, fabsl((long double)at->m[j][i]));
    }
    const long double least = fabsl(det) - 21.0L / 16 * size / (1 << 22) - largest * 0x1p-120L;
    if (!(least > 0) || size >= 0x1p120L || most >= 0x1p120L)
        return 0;
    return (double)(17.0L / 16 * most / least);
}

static int class_at(double growth)
{
    return growth <= 0x1p8 ? 0 : growth <= 0x1p20 ? 1 : growth <= 0x1p32 ? 2 : 3;
}

/* The classes of a world, all of whose instances have one. */
static void classes_of(const struct world *world, struct class_of out[CLASSES])
{
    memset(out, 0, CLASSES * sizeof *out);
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *at = &world->instance[i];
        double growth = growth_of(at);
        struct class_of *class = &out[class_at(growth)];
        assert_true(growth > 0);
        class->growth = fmax(class->growth, growth);
        for (int k = 0; k < 3; k++)
            class->far = fmax(class->far, fabs((double)at->m[k][3]));
    }
}

static double largest(const float v[3])
{
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fabs((double)v[k]));
    return most;
}

/* --- which transforms there may be ------------------------------------------------------------ */

/* A diagonal in every order of rows and columns and every sign. */
static void permute(const float diagonal[3], int rows, int columns, int signs, struct instance *out)
{
    memset(out->m, 0, sizeof out->m);
    for (int k = 0; k < 3; k++)
        out->m[permutation[rows][k]][permutation[columns][k]] =
            signs >> k & 1 ? -diagonal[k] : diagonal[k];
}

/* Neighbours: what is refused, and what is not. Subnormals and what has no finite inverse, on the
 * diagonal; the largest number decides how much is lost, wherever it is. */
static const float ends[][2][3] = {
    {{0x1p60f, 0x1p-60f, 0x1p-61f}, {0x1p60f, 0x1p-60f, 0x1p-59f}},
    {{0x1p-40f, 0x1p-40f, 0x1p-40f}, {0x1p-40f, 0x1p-40f, 0x1p-39f}},
    {{0x1p40f, 0x1p40f, 0x1p40f}, {0x1p40f, 0x1p40f, 0x1p39f}},
    {{0x1p-10f, 0x1p60f, 0x1p60f}, {0x1p-10f, 0x1p60f, 0x1p59f}},
};

static void transforms_are_refused_from_the_border_on(void **state)
{
    (void)state;
    struct world world = laws_room(1, 1);
    void *self = opened(false, false);
    laws_mesh(world.mesh, (const uint32_t[]){1}, 1);
    laws_finish(&world);
    for (size_t e = 0; e < ARRAY_COUNT(ends); e++)
        for (int which = 0; which < 2 * 6 * 6 * 8; which++) {
            struct reason reason = {""};
            bool refused = which % 2 == 0;
            permute(ends[e][which % 2], which / 2 % 6, which / 12 % 6, which / 72, world.instance);
            assert_int_equal(growth_of(world.instance) == 0, refused);
            assert_int_equal(prepared(self, &world, QUERY_CLOSEST, &reason),
                             refused ? STATUS_UNSUPPORTED : STATUS_OK);
            assert_int_equal(strncmp(reason.text, "Embree: instance 0:", 19) == 0, refused);
        }
    engine->close(self);
    world_free(&world);
}

/* Two columns that are nearly the same, in every place. */
static void near_columns_are_refused_from_the_border_on(void **state)
{
    (void)state;
    struct world world = laws_room(1, 1);
    void *self = opened(false, false);
    laws_mesh(world.mesh, (const uint32_t[]){1}, 1);
    laws_finish(&world);
    for (int rows = 0; rows < 6; rows++)
        for (int columns = 0; columns < 6; columns++)
            for (int bits = 18; bits <= 23; bits++) {
                const int *r = permutation[rows], *c = permutation[columns];
                struct reason reason = {""};
                permute((const float[]){1, 1, 1}, rows, columns, 0, world.instance);
                world.instance->m[r[0]][c[1]] = 1;
                world.instance->m[r[1]][c[0]] = 1;
                world.instance->m[r[1]][c[1]] = 1 + ldexpf(1, -bits);
                enum status status = prepared(self, &world, QUERY_CLOSEST, &reason);
                assert_int_equal(status, bits < 21 ? STATUS_OK : STATUS_UNSUPPORTED);
                assert_int_equal(growth_of(world.instance) > 0, bits < 21);
            }
    engine->close(self);
    world_free(&world);
}

/* Without the guard none is, and it is in the first class. */
static void without_the_guard_none_is_refused(void **state)
{
    (void)state;
    struct world world = laws_room(1, 1);
    void *self = opened(true, false);
    laws_mesh(world.mesh, (const uint32_t[]){1}, 1);
    world.instance->mask = 0x5A;
    laws_finish(&world);
    for (size_t e = 0; e < ARRAY_COUNT(ends); e++) {
        struct reason reason = {""};
        permute(ends[e][0], 0, 0, 0, world.instance);
        assert_int_equal(prepared(self, &world, QUERY_CLOSEST, &reason), STATUS_OK);
        assert_int_equal(calls.masks, 2);
        assert_int_equal(calls.mask[1], 0x5A);
    }
    engine->close(self);
    world_free(&world);
}

/* --- masks ------------------------------------------------------------------------------------ */

/* Geometries let every ray in, instances those of their mask and class. */
static void masks_of_instances_are_those_of_their_class(void **state)
{
    (void)state;
    struct world world = laws_room(1, 1);
    void *self = opened(false, false);
    laws_mesh(world.mesh, (const uint32_t[]){1, 2, 1}, 3);
    laws_finish(&world);
    for (int power = -20; power < 39; power++)
        for (int which = 0; which < 36; which++) {
            const float s = ldexpf(1, -power);
            struct reason reason = {""};
            permute((const float[]){s, 1.5f * s, -s}, which % 6, which / 6, 0, world.instance);
            world.instance->mask = 1 + (uint32_t)which * 7;
            assert_int_equal(prepared(self, &world, QUERY_CLOSEST, &reason), STATUS_OK);
            assert_int_equal(calls.masks, 4);
            for (int geometry = 0; geometry < 3; geometry++)
                assert_int_equal(calls.mask[geometry], 0xFFFFFFFFu);
            assert_int_equal(calls.mask[3],
                             world.instance->mask << 8 * class_at(growth_of(world.instance)));
        }
    engine->close(self);
    world_free(&world);
}

/* Up to six instances, up to 2^40 times as small as the world, some of them far away. */
static struct world drawn_world(struct rng *rng)
{
    struct world world = laws_room(1, 1 + rng_below(rng, 6));
    laws_mesh(world.mesh, (const uint32_t[]){1}, 1);
    for (uint32_t i = 0; i < world.instance_count; i++) {
        struct instance *at = &world.instance[i];
        float s = ldexpf(1, -(int)rng_below(rng, 38));
        const int rows = (int)rng_below(rng, 6);
        permute((const float[]){s, s, s}, rows, 0, (int)rng_below(rng, 8), at);
        for (int k = 0; k < 9; k++)
            at->m[k / 3][k % 3] += s * 0.25f * (2 * rng_float(rng) - 1);
        for (int k = 0; k < 3; k++)
            at->m[k][3] = rng_below(rng, 3) ? 0 : ldexpf(rng_float(rng) - 0.5f, 60);
        at->mask = 1 + rng_below(rng, 255);
    }
    laws_finish(&world);
    return world;
}

/* A vector whose largest coordinate, on any axis and of either sign, is `most`. */
static void draw_vector(struct rng *rng, double most, float out[3])
{
    const uint32_t axis = rng_below(rng, 3);
    for (uint32_t k = 0; k < 3; k++)
        out[k] = (float)(most * (k == axis ? 1 : (double)rng_float(rng) * 0.9)) *
                 (rng_below(rng, 2) ? 1 : -1);
}

/* A ray whose origin or direction is just short of the border of a class, or just beyond. */
static struct ray drawn_ray(struct rng *rng, const struct class_of class[CLASSES])
{
    const struct class_of *of = &class[rng_below(rng, CLASSES)];
    const double beside = rng_below(rng, 2) ? 1e-6 : -1e-6;
    const double border = (of->growth > 0 ? MOST / of->growth : 0x1p50) * (1 + beside);
    struct ray ray = {.tmax = INFINITY};
    bool far = rng_below(rng, 2) && border > of->far;
    draw_vector(rng, far ? border - of->far : rng_below(rng, 2) ? 0.5 * border : 1, ray.org);
    draw_vector(rng, far ? 1 : border, ray.dir);
    return ray;
}

/* The mask that a ray has, 0 if it is not traced. Returns false within a hair of a border. */
static bool mask_for(const struct class_of class[CLASSES], const struct ray *ray,
                     struct ray_mode mode, bool masks, uint32_t *out)
{
    bool clear = true, unsafe = false;
    *out = 0;
    for (int i = 0; i < CLASSES; i++) {
        double reach = fmax(class[i].growth * (largest(ray->org) + class[i].far),
                            class[i].growth * largest(ray->dir));
        clear = clear && fabs(reach / MOST - 1) > 1e-7;
        if (reach < MOST)
            *out |= mode.mask << 8 * i;
        else
            unsafe = true;
    }
    if ((!masks && unsafe) || (mode.flags & ABI_RAY_SKIP_TRIANGLES))
        *out = 0;
    return clear;
}

static void trace_one(void *self, const struct ray *ray, const struct ray_mode *mode,
                      enum query query)
{
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit;
    uint32_t tag, count;
    const struct world_tracer *worlds = engine->worlds;
    calls.closest = calls.any = 0;
    enum status status =
        query == QUERY_ALL
            ? worlds->trace_world_all(self, ray, mode, 1, 1, &hit, &tag, &count, &reason)
            : worlds->trace_world(self, ray, mode, 1, &hit, &tag, &report, &reason);
    if (status)
        fail_msg("%s", reason.text);
    assert_true(query == QUERY_ALL ? count == 0 : hit.prim == ABI_NO_PRIM && tag == 0);
}

static void a_ray_has_the_masks_of_the_classes_that_bear_it(void **state)
{
    (void)state;
    uint32_t none = 0, some = 0, all = 0;
    for (uint32_t trial = 0; trial < 300; trial++) {
        const bool masks = trial % 3 != 0, unguarded = trial % 7 == 6;
        struct rng rng = rng_make(5, trial);
        struct world world = drawn_world(&rng);
        struct class_of class[CLASSES];
        void *self = opened(unguarded, !masks);
        struct reason reason = {""};
        const enum query query = (enum query)(trial % 3 == 0 ? trial / 3 % 3 : trial % 3);
        classes_of(&world, class);
        assert_int_equal(prepared(self, &world, query, &reason), STATUS_OK);
        calls.answer = miss;
        for (uint32_t i = 0; i < 100; i++) {
            struct ray ray = drawn_ray(&rng, class);
            const uint32_t flags[] = {0, 0, ABI_RAY_FIRST, ABI_RAY_SKIP_TRIANGLES};
            const struct ray_mode mode = {rng_below(&rng, 256), flags[i % 4]};
            uint32_t want;
            if (!mask_for(class, &ray, mode, masks, &want) || largest(ray.org) >= MOST ||
                largest(ray.dir) >= MOST)
                continue;
            if (unguarded && !(mode.flags & ABI_RAY_SKIP_TRIANGLES))
                want = mode.mask * 0x01010101u;
            bool any = query == QUERY_ANY || (query == QUERY_CLOSEST && flags[i % 4]);
            trace_one(self, &ray, &mode, query);
            assert_int_equal(calls.any, want && any);
            assert_int_equal(calls.closest, want && !any);
            if (want)
                assert_int_equal(calls.ray.mask, want);
            none += want == 0;
            some += want && want != mode.mask * 0x01010101u;
            all += want && want == mode.mask * 0x01010101u;
        }
        engine->close(self);
        world_free(&world);
    }
    assert_true(none > 2000 && some > 2000 && all > 2000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(transforms_are_refused_from_the_border_on),
        cmocka_unit_test(near_columns_are_refused_from_the_border_on),
        cmocka_unit_test(without_the_guard_none_is_refused),
        cmocka_unit_test(masks_of_instances_are_those_of_their_class),
        cmocka_unit_test(a_ray_has_the_masks_of_the_classes_that_bear_it),
    };
    return calls_can_run() ? cmocka_run_group_tests_name("embree_guard", tests, NULL, NULL) : 0;
}

#else

int main(void)
{
    puts("SKIP built without Embree");
    return 0;
}

#endif
