/* What test_diff_why.c and test_diff_why_held.c share; includes cmocka.h. */
#ifndef DIFF_WHY_FIXTURE_H
#define DIFF_WHY_FIXTURE_H

#include "scenes/render/camera.h"
#include "scenes/render/diff_engines.h"
#include "scenes/scenes.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

/* Quads 4 and 5 lie on the wall, and an ulp beside the side wall. */
#define QUADS 6u

#define WIDTH  24u
#define HEIGHT 18u

static struct reason reason;

/* What is wrong with the answers of the second tracer. */
enum why_lie {
    NONE,
    ULP,         /* t and u one float on */
    FAR_OFF,     /* t a thousandth on */
    OTHER_PRIM,  /* the triangle after the right one */
    LOST_HIT,    /* a miss */
    LOST_SHADOW, /* shadow rays reach the light */
    MADE_SHADOW, /* shadow rays meet triangle 0 */
    TWIN_PRIM,   /* of two triangles that lie on or beside each other the other one */
};

static struct {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct shading shading;
    struct frame_job job;
    struct camera camera;
    struct view view;
    struct oracle *oracle;
    struct side cpu;
    struct why_judges judges;
    enum why_lie lie;
    uint32_t at; /* the wave in which it is told, counted from 0 */
    uint32_t wave;
} s;

static enum status honest(void *user, enum query query, const struct ray *ray, size_t count,
                          struct hit *hit, struct reason *why)
{
    (void)user;
    return renderer_ask(s.cpu.renderer, query, ray, count, hit, why);
}

/* The triangle of the quad on or beside a triangle's own; itself if there is none. */
static uint32_t twin_of(uint32_t prim)
{
    static const uint32_t other[QUADS] = {0, 4, 5, 3, 1, 2};
    return 2 * other[prim / 2] + prim % 2;
}

static void tell(enum why_lie lie, enum query query, struct hit *hit)
{
    bool shadow = query == QUERY_ANY;
    if (lie == LOST_SHADOW || lie == MADE_SHADOW) {
        if (!shadow || (lie == LOST_SHADOW) != (hit->prim != ABI_NO_PRIM))
            return;
        *hit = lie == LOST_SHADOW ? (struct hit){0, 0, 0, ABI_NO_PRIM} : (struct hit){1, 0, 0, 0};
        return;
    }
    if (shadow || hit->prim == ABI_NO_PRIM)
        return;
    if (lie == ULP) {
        hit->t = nextafterf(hit->t, INFINITY);
        hit->u = nextafterf(hit->u, 0);
    } else if (lie == FAR_OFF) {
        hit->t *= 1.001f;
    } else if (lie == OTHER_PRIM) {
        hit->prim = (hit->prim + 1) % s.scene.tri_count;
    } else if (lie == TWIN_PRIM) {
        hit->prim = twin_of(hit->prim);
    } else if (lie == LOST_HIT) {
        *hit = (struct hit){0, 0, 0, ABI_NO_PRIM};
    }
}

static enum status lying(void *user, enum query query, const struct ray *ray, size_t count,
                         struct hit *hit, struct reason *why)
{
    enum status status = honest(user, query, ray, count, hit, why);
    for (size_t i = 0; i < count && s.wave >= s.at; i++)
        tell(s.lie, query, &hit[i]);
    s.wave++;
    return status;
}

static size_t every[WIDTH * HEIGHT];

static void walk(walk_ask_fn *ask, struct diff_walk *out)
{
    s.wave = 0;
    for (size_t i = 0; i < ARRAY_COUNT(every); i++)
        every[i] = i;
    assert_int_equal(walk_make(&s.job, &s.view, every, ARRAY_COUNT(every), ask, NULL, out, &reason),
                     STATUS_OK);
}

/* Walks both and counts why they part. */
static void count_whys(enum why_lie lie, uint32_t from_wave, size_t why[WHY_COUNT])
{
    struct diff_walk a, b;
    memset(why, 0, WHY_COUNT * sizeof *why);
    s.lie = lie;
    s.at = from_wave;
    walk(honest, &a);
    walk(lying, &b);
    for (size_t i = 0; i < a.count; i++) {
        struct path_why found;
        assert_int_equal(why_paths(&s.judges, &a, &b, i, &found, &reason), STATUS_OK);
        why[found.why]++;
        if (found.why == WHY_WRONG)
            assert_int_equal(found.side, 1); /* never the honest one */
        if (found.why == WHY_SAME)
            assert_int_equal(a.frame.pixel[i], b.frame.pixel[i]);
    }
    walk_free(&a);
    walk_free(&b);
}

static void add_quad(struct scene *out, uint32_t quad, const float corner[4][3], int32_t material)
{
    static const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
    memcpy(out->vertex + 12 * (size_t)quad, corner, 12 * sizeof(float));
    for (size_t k = 0; k < 6; k++)
        out->index[6 * (size_t)quad + k] = 4 * quad + order[k];
    out->material_of[2 * quad] = out->material_of[2 * quad + 1] = material;
}

static void make_scene(struct scene *out)
{
    static const float floor_[4][3] = {{-4, 0, -4}, {4, 0, -4}, {4, 0, 4}, {-4, 0, 4}};
    static const float wall[4][3] = {{-4, 0, 4}, {4, 0, 4}, {4, 5, 4.5f}, {-4, 5, 4.5f}};
    static const float side[4][3] = {{-4, 0, -4}, {-4, 0, 4}, {-4.3f, 5, 4}, {-4.3f, 5, -4}};
    static const float shade[4][3] = {{-1, 2, -1}, {1.3f, 2.2f, -1}, {1.1f, 2, 1}, {-1, 1.9f, 1}};
    float beside[4][3];
    assert_int_equal(scene_make(4 * QUADS, 2 * QUADS, out), STATUS_OK);
    out->material_of = alloc_zeroed(2 * QUADS, sizeof *out->material_of);
    out->material = alloc_zeroed(2, sizeof *out->material);
    out->light = alloc_zeroed(2, sizeof *out->light);
    assert_true(out->material_of && out->material && out->light);
    out->material_count = 2;
    out->light_count = 2;
    add_quad(out, 0, floor_, 0);
    add_quad(out, 1, wall, 1);
    add_quad(out, 2, side, 1);
    add_quad(out, 3, shade, 0);
    add_quad(out, 4, wall, 1);
    memcpy(beside, side, sizeof beside);
    for (int c = 0; c < 4; c++)
        beside[c][0] = nextafterf(beside[c][0], 0);
    add_quad(out, 5, beside, 1);
    out->material[0] = (struct material){{0.8f, 0.6f, 0.3f}, {0.7f, 0.3f, 0.2f}, 20};
    out->material[1] = (struct material){{0.3f, 0.6f, 0.8f}, {0.2f, 0.5f, 0.9f}, 50};
    out->light[0] = (struct light){{0.3f, 5, -0.4f}, 0.9f};
    out->light[1] = (struct light){{-2.5f, 4, -1.5f}, 0.4f};
    out->camera = (struct camera){{3.1f, 4.2f, -7}, {-0.5f, 1, 0.5f}, true};
    out->has_camera = true;
}

static void prepare(enum profile profile)
{
    struct look *look = &s.job.look;
    *look = (struct look){.profile = profile, .bounces = 3, .ambience = 0.1f};
    assert_int_equal(shading_make(&s.scene, look, &s.shading, &reason), STATUS_OK);
    s.job.job = (struct job){.scene = &s.scene,
                             .packed = &s.packed,
                             .box = box_tests[0],
                             .tri = tri_tests[0],
                             .query = QUERY_CLOSEST};
    s.job.width = WIDTH;
    s.job.height = HEIGHT;
    s.camera = scene_camera(&s.scene);
    frame_job_fill(&s.shading, &s.camera, &s.job);
    s.view = camera_view(&s.camera, profile, WIDTH, HEIGHT);
    struct engine_options options = {.device = -1};
    enum status status = side_open(engine_find("cpu"), &options, &s.job, false, &s.cpu, &reason);
    assert_int_equal(status, STATUS_OK);
    const struct model model[2] = {s.cpu.model, s.cpu.model};
    enum query query = profile == PROFILE_RTRS ? QUERY_CLOSEST : QUERY_ANY;
    assert_int_equal(why_judges_make(s.oracle, model, query, &s.judges, &reason), STATUS_OK);
}

static void forget(void)
{
    why_judges_free(&s.judges);
    side_close(&s.cpu);
    shading_free(&s.shading);
}

static int begin(void **state)
{
    (void)state;
    struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    make_scene(&s.scene);
    assert_int_equal(scene_check(&s.scene, &reason), STATUS_OK);
    assert_int_equal(builders[0]->build(&s.scene, &build, &s.bvh, &reason), STATUS_OK);
    assert_int_equal(packed_make(layout_find("f32"), &s.bvh, &s.scene, &s.packed, &reason),
                     STATUS_OK);
    assert_int_equal(oracle_make(&s.scene, &s.oracle, &reason), STATUS_OK);
    prepare(PROFILE_REPAIRED);
    return 0;
}

static int end(void **state)
{
    (void)state;
    forget();
    oracle_free(s.oracle);
    packed_free(&s.packed);
    bvh_free(&s.bvh);
    scene_free(&s.scene);
    return 0;
}

static void a_walk_is_the_picture(void **state)
{
    (void)state;
    struct diff_walk paths;
    size_t shadows = 0, bounced = 0;
    assert_int_equal(side_draw(&s.cpu, &s.view, &reason), STATUS_OK);
    assert_int_equal(side_walk(&s.cpu, &s.view, every, 0, &paths, &reason), STATUS_OK);
    walk_free(&paths);
    walk(honest, &paths);
    for (size_t i = 0; i < paths.count; i++) {
        const struct segment *segment = s.cpu.frame.segment + i * s.job.look.bounces;
        assert_true(why_walk_is_frame(&paths, i, segment, s.cpu.frame.pixel[i], true));
        assert_memory_equal(&paths.frame.color[3 * i], &s.cpu.frame.color[3 * i], 12);
        assert_true(paths.frame.bound[i] == s.cpu.frame.bound[i]);
        shadows += segment[0].shadowed != 0 && segment[0].prim != ABI_NO_PRIM;
        bounced += paths.length[i] > 1;
        assert_false(why_walk_is_frame(&paths, i, segment, s.cpu.frame.pixel[i] ^ 0x20u, false));
        struct segment other[3];
        memcpy(other, segment, sizeof other);
        other[0].shadowed ^= 1u;
        assert_false(why_walk_is_frame(&paths, i, other, s.cpu.frame.pixel[i], false));
    }
    assert_true(shadows > 5 && bounced > 50); /* else nothing below is tested */
    walk_free(&paths);
}

#endif
