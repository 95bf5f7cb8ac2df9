/* Seams: a ray that is moved into the space of a mesh may pass from a part that the exact ray meets
 * into its neighbour. The boxes of a braided top are tested wide enough for that, and no hit of a
 * watertight test is lost; without it hits are. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "ref/world/object_ray.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/braid_stand.h"

#define TILES 8
#define RAYS  20000

/* How the box of tiles is placed. Where seams lie along axes of the world, the numbers are such
 * that placed vertices are float32 numbers: else the boxes of parts, rounded outward, hide what is
 * lost. */
enum seam_kind {
    SEAM_STRETCHED, /* other sizes along each axis: seams along axes, and an inverse that is not
                       exact */
    SEAM_EXCHANGED, /* the same with axes exchanged and mirrored */
    SEAM_MOVED,     /* the same, away from where T is subtracted */
    SEAM_UPRIGHT,   /* sheared, and the mesh the other way, so that it is upright when placed */
    SEAM_TURNED,    /* turned anyhow, stretched and moved */
    SEAM_SHEARED,   /* sheared and stretched */
    SEAM_KINDS
};

#define SHEAR 6

/* The point of the mesh whose place, but for size and T, is p. */
static void seam_point(enum seam_kind kind, const float p[3], float out[3])
{
    out[0] = kind == SEAM_UPRIGHT ? p[0] - SHEAR * p[1] : p[0];
    out[1] = p[1];
    out[2] = p[2];
}

static void seam_matrix(enum seam_kind kind, uint64_t seed, float m[3][4])
{
    static const float size[3] = {0.75f, 0.375f, 1.25f};
    const bool exact = kind <= SEAM_UPRIGHT;
    struct rng rng = rng_make(seed, kind);
    if (kind == SEAM_TURNED) {
        fixture_turn(&rng, m);
    } else if (kind == SEAM_SHEARED) {
        m[0][1] = 0.37f;
        m[1][2] = -0.21f;
    } else if (kind == SEAM_EXCHANGED) {
        m[0][0] = m[1][1] = m[2][2] = 0;
        m[0][1] = m[2][0] = 1;
        m[1][2] = -1;
    }
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            m[r][c] *= kind == SEAM_UPRIGHT ? 1 : size[c] * (exact ? 1 : rng_range(&rng, 0.9f, 1));
    if (kind == SEAM_UPRIGHT)
        m[0][1] = SHEAR;
    for (int r = 0; r < 3; r++)
        m[r][3] = kind == SEAM_MOVED ? (float)(r + 1) : exact ? 0 : rng_range(&rng, -1, 1);
}

static struct world seam_world(enum seam_kind kind, uint64_t seed)
{
    struct world world = fixture_room(1, 1);
    tiled_box(&world, 0, TILES);
    struct scene *scene = world.mesh[0].scene;
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        seam_point(kind, scene->vertex + 3 * i, scene->vertex + 3 * i);
    seam_matrix(kind, seed, world.instance[0].m);
    fixture_finish(&world);
    return world;
}

static float placed(const struct instance *instance, int k, const float p[3])
{
    const float *m = instance->m[k];
    return (float)((double)m[0] * (double)p[0] + (double)m[1] * (double)p[1] +
                   (double)m[2] * (double)p[2] + (double)m[3]);
}

/* A ray from inside the box at a point of an edge between tiles, a corner of one every third time.
 * Of most rays the origin is nearly in a plane of seams: the allowance of the box test itself,
 * 2^-18 of the distance along the ray, covers what is lost of others. */
static struct ray seam_ray(const struct instance *instance, enum seam_kind kind, struct rng *rng)
{
    const uint32_t face = rng_below(rng, 6), i = rng_below(rng, TILES), j = rng_below(rng, TILES);
    float a[3], b[3], from[3], at[3], s = rng_below(rng, 3) ? rng_float(rng) : 0;
    struct ray ray = {.tmax = STAND_TMAX};
    tile_corner(TILES, face, i, j, 0, a);
    tile_corner(TILES, face, i, j, 1 + rng_below(rng, 2), b);
    for (int k = 0; k < 3; k++) {
        at[k] = a[k] + s * (b[k] - a[k]);
        from[k] = rng_range(rng, -0.9f, 0.9f);
    }
    const uint32_t beside = rng_below(rng, 4);
    const int down = (int)rng_below(rng, 26);
    if (beside < 3 && fabsf(at[beside]) < 1)
        from[beside] = at[beside] + ldexpf(rng_range(rng, -1, 1), -down);
    seam_point(kind, at, at);
    seam_point(kind, from, from);
    for (int k = 0; k < 3; k++) {
        ray.org[k] = placed(instance, k, from);
        ray.dir[k] = placed(instance, k, at) - ray.org[k];
        ray.dir[k] += rng_range(rng, -1, 1) * 0x1p-23f; /* less than the point is known by */
    }
    return ray;
}

/* Rays of `count` that leave the closed box without a hit. */
static uint32_t lost(const struct world *world, const struct packed_world *packed,
                     enum seam_kind kind, uint32_t count, uint64_t seed)
{
    struct world_job job = stand_job(world, packed, QUERY_CLOSEST);
    struct rng rng = rng_make(seed, 1);
    uint32_t misses = 0;
    job.tri = tri_test_find("woop");
    for (uint32_t i = 0; i < count; i++) {
        const struct ray ray = seam_ray(&world->instance[0], kind, &rng);
        misses += stand_trace(&job, &ray, ray_mode_all()).hit.prim == ABI_NO_PRIM;
    }
    return misses;
}

static struct packed_world without_width(const struct packed_world *packed)
{
    struct packed_world narrow = *packed; /* borrows everything */
    narrow.share = narrow.reach = 0;
    return narrow;
}

static void no_hit_is_lost_at_a_seam(void **state)
{
    (void)state;
    uint32_t rays = 0, narrow_lost = 0;
    for (enum seam_kind kind = 0; kind < SEAM_KINDS; kind++) {
        uint32_t of_kind = 0;
        for (uint64_t seed = 0; seed < 6; seed++, rays += 5000) {
            struct world world = seam_world(kind, seed);
            struct packed_world packed =
                braid_world(&world, seed % 2 ? "sah_sweep" : "median", "f32", BRAID_MOST);
            const struct packed_world narrow = without_width(&packed);
            assert_true(packed.entry_count > 30);
            assert_int_equal(lost(&world, &packed, kind, 5000, seed), 0);
            of_kind += lost(&world, &narrow, kind, 5000, seed);
            packed_world_free(&packed);
            world_free(&world);
        }
        print_message("%u ", of_kind);
        assert_true(of_kind > 10 || kind > SEAM_UPRIGHT);
        narrow_lost += of_kind;
    }
    print_message("of %u rays at seams are lost if boxes are not tested wider, else 0\n", rays);
    assert_true(narrow_lost > 50);
}

/* Layouts that round boxes outward, and other leaves. */
static void nor_in_any_layout(void **state)
{
    (void)state;
    uint32_t count = 0;
    for (size_t i = 0; layouts_all[i]; i++) {
        if (layouts_all[i]->faithful)
            continue;
        const enum seam_kind kind = (enum seam_kind)(i % SEAM_KINDS);
        struct world world = seam_world(kind, i);
        struct world_trees trees = braid_trees(&world, "sah_sweep", 1 + (uint32_t)i % 3, 40);
        struct packed_world packed =
            stand_packed(&world, &trees, layouts_all[i]->name, layouts_all[i]->name);
        assert_true(packed.entry_count > 20);
        assert_int_equal(lost(&world, &packed, kind, 1000, i), 0);
        count++;
        packed_world_free(&packed);
        world_trees_free(&trees);
        world_free(&world);
    }
    assert_true(count > 50);
}

/* Rays of `count` whose bits on engine vulkan are not cpu's, or that it loses. */
static uint32_t differ_on(const struct engine *vulkan, void *self, enum seam_kind kind)
{
    static struct ray ray[RAYS];
    static struct hit hit[RAYS];
    static uint32_t tag[RAYS];
    struct world world = seam_world(kind, 1);
    struct packed_world packed = braid_world(&world, "median", "f32", BRAID_MOST);
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct rng rng = rng_make(4, kind);
    struct trace_report report;
    struct reason reason = {""};
    uint32_t count = 0;
    job.tri = tri_test_find("woop");
    for (uint32_t i = 0; i < RAYS; i++)
        ray[i] = seam_ray(&world.instance[0], kind, &rng);
    if (vulkan->worlds->prepare_world(self, &job, &reason) ||
        vulkan->worlds->trace_world(self, ray, NULL, RAYS, hit, tag, &report, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t i = 0; i < RAYS; i++) {
        const struct tagged cpu = stand_trace(&job, &ray[i], ray_mode_all());
        count += hit[i].prim == ABI_NO_PRIM || tag[i] != cpu.tag ||
                 memcmp(&cpu.hit, &hit[i], sizeof *hit) != 0;
    }
    packed_world_free(&packed);
    world_free(&world);
    return count;
}

static void nor_by_the_shader(void **state)
{
    (void)state;
    const struct engine *vulkan = engine_find("vulkan");
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    void *self;
    if (engine_open(vulkan, &options, &self, &reason)) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    for (enum seam_kind kind = 0; kind < SEAM_KINDS; kind++)
        assert_int_equal(differ_on(vulkan, self, kind), 0);
    vulkan->close(self);
}

/* --- the bound -------------------------------------------------------------------------------- */

/* How far the moved ray is from the exact one at t, in the world: the largest coordinate of M (o' +
 * t d') + T - (o + t d). Products of three float32 numbers have 72 bits: what a long double of 64
 * lacks of them is far below what is measured. */
static double moved_by(const struct instance *instance, const struct ray *ray,
                       const struct ray *moved, float t)
{
    double most = 0;
    for (int k = 0; k < 3; k++) {
        const float *m = instance->m[k];
        long double sum = (long double)m[3] - (long double)ray->org[k] -
                          (long double)t * (long double)ray->dir[k];
        for (int j = 0; j < 3; j++)
            sum += (long double)m[j] *
                   ((long double)moved->org[j] + (long double)t * (long double)moved->dir[j]);
        most = fmax(most, fabs((double)sum));
    }
    return most;
}

/* Part of the width that the transform of a ray at a point of the mesh takes: at most 15 of 64 by
 * the proof in ref/two_level/braid.h, of sums and products as IEEE 754 has them. */
static void the_width_covers_what_transforms_move(void **state)
{
    (void)state;
    double most = 0;
    uint32_t count = 0;
    for (uint64_t seed = 0; seed < 2000; seed++) {
        struct world world =
            fixture_world("soup:n=4", (enum world_kind)(seed % WORLD_KINDS), 1, seed);
        const struct instance *instance = &world.instance[0];
        struct instance_record *record;
        struct box *box;
        float share, reach;
        assert_int_equal(world_records_make(&world, &record, NULL), STATUS_OK);
        assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &box, NULL), STATUS_OK);
        struct rng rng = rng_make(23, seed);
        const bool sound = braid_needs(&world, 0, box, &share, &reach);
        for (int i = 0; i < 200 && sound; i++) {
            const float *p = world.mesh[0].scene->vertex + 3 * rng_below(&rng, 12);
            struct ray ray = {.tmax = STAND_TMAX};
            for (int k = 0; k < 3; k++) {
                ray.org[k] = rng_range(&rng, -2, 2) * (i % 2 ? reach : 1);
                ray.dir[k] = (placed(instance, k, p) - ray.org[k]) * 0.75f;
            }
            const struct ray moved = transform_ray(record, &ray);
            const double part = moved_by(instance, &ray, &moved, 4.0f / 3) /
                                (double)braid_width(share, reach, ray.org);
            assert_true(part < 15.0 / 64);
            most = fmax(most, part);
            count++;
        }
        free(record);
        free(box);
        world_free(&world);
    }
    print_message("transforms moved rays by up to %.3f of the width, of %u\n", most, count);
    assert_true(most > 0.5 / 64 && count > 200000);
}

/* `side` is half of the mesh's. */
static bool has_bound_of(float side, float scale, float shear, float far, float *share,
                         float *reach)
{
    struct world world = fixture_room(1, 1);
    struct box *box;
    tiled_box(&world, 0, 1);
    for (uint32_t i = 0; i < 3 * world.mesh[0].scene->vertex_count; i++)
        world.mesh[0].scene->vertex[i] *= side;
    float(*m)[4] = world.instance[0].m;
    for (int k = 0; k < 3; k++)
        m[k][k] = scale;
    m[0][1] = shear * scale;
    m[2][3] = far;
    fixture_finish(&world);
    assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &box, NULL), STATUS_OK);
    const bool has = braid_needs(&world, 0, box, share, reach);
    free(box);
    world_free(&world);
    return has;
}

static bool has_bound(float scale, float shear, float far, float *share, float *reach)
{
    return has_bound_of(1, scale, shear, far, share, reach);
}

/* The share is 64 u kappa, the reach what is largest; each end of what the proof is for. */
static void the_bound_has_conditions(void **state)
{
    (void)state;
    float share, reach;
    assert_true(has_bound(1, 0, 0, &share, &reach));
    assert_true(share >= 0x1p-18f && share < 0x1.001p-18f && reach >= 2 && reach < 2.001f);
    assert_true(has_bound(1, 0, -9, &share, &reach));
    assert_true(reach >= 10 && reach < 10.001f);     /* the corner at -10 */
    assert_true(has_bound(1, 4, 0, &share, &reach)); /* (1 + 4) 2, and 1 + 2 * 4 */
    assert_true(share >= 9 * 0x1p-18f && share < 9.01f * 0x1p-18f && reach >= 10);
    assert_true(has_bound(1, 511, 0, &share, &reach)); /* kappa 1023 */
    assert_false(has_bound(1, 512, 0, &share, &reach));
    assert_true(has_bound(0x1p38f, 0, 0, &share, &reach));
    assert_false(has_bound(0x1p40f, 0, 0, &share, &reach));
    assert_true(has_bound(0x1p-38f, 0, 0, &share, &reach));
    assert_false(has_bound(0x1p-42f, 0, 0, &share, &reach));
    assert_false(has_bound(0x1p-42f, 0, 1, &share, &reach)); /* the inverse is too large */
    assert_false(has_bound(1, 0, 0x1p40f, &share, &reach));
    assert_true(has_bound_of(0x1p-20f, 0x1p-20f, 0, 0, &share, &reach));
    assert_false(has_bound_of(0x1p-21f, 0x1p-21f, 0, 0, &share, &reach)); /* all is too small */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_hit_is_lost_at_a_seam),
        cmocka_unit_test(nor_in_any_layout),
        cmocka_unit_test(nor_by_the_shader),
        cmocka_unit_test(the_bound_has_conditions),
        cmocka_unit_test(the_width_covers_what_transforms_move),
    };
    return cmocka_run_group_tests_name("braid_seams", tests, NULL, NULL);
}
