/* What the tests of RTRS's faults share: trees in a layout that can be asked rays. Include
 * after cmocka.h. */
#ifndef TESTS_FAULTS_H
#define TESTS_FAULTS_H

#include "ref/trace/trace.h"
#include "scenes/scenes.h"
#include "tests/support/counted.h"
#include "tests/support/tree_fixture.h"

#include <stdio.h>
#include <string.h>

/* The options of RTRS's own programs; leaf 2 is for its direct handler. */
#define SEED_LEAF 4
#define SEED_EPS  0.02f

/* A tree, and one packed form of it. */
struct subject {
    const struct scene *scene;
    struct bvh bvh;
    struct bvh_stats stats;
    struct packed packed;
    struct reason reason; /* if packing was refused */
    enum status status;
};

static inline void subject_pack(struct subject *s, const char *layout)
{
    packed_free(&s->packed);
    s->reason.text[0] = 0;
    s->status = packed_make(layout_find(layout), &s->bvh, s->scene, &s->packed, &s->reason);
}

/* Fails the test if the tree cannot be built; a refused layout is for the test to judge. */
static inline struct subject subject_make(const struct scene *scene, const char *builder,
                                          uint32_t leaf, float eps, const char *layout)
{
    struct subject s = {.scene = scene};
    struct build_options options = {.leaf = leaf, .eps = eps};
    if (builder_find(builder)->build(scene, &options, &s.bvh, &s.reason))
        fail_msg("%s: %s", builder, s.reason.text);
    s.stats = bvh_counted(&s.bvh, scene);
    subject_pack(&s, layout);
    return s;
}

/* The same for a hand-made tree, which the subject then owns. */
static inline struct subject subject_of(const struct scene *scene, struct bvh bvh,
                                        const char *layout)
{
    struct subject s = {.scene = scene, .bvh = bvh, .stats = bvh_counted(&bvh, scene)};
    subject_pack(&s, layout);
    return s;
}

static inline void subject_free(struct subject *s)
{
    packed_free(&s->packed);
    bvh_free(&s->bvh);
}

static inline struct hit subject_hit(const struct subject *s, const char *box, const char *tri,
                                     struct ray ray, struct trace_counts *counts)
{
    struct hit hit;
    if (s->status)
        fail_msg("%s", s->reason.text);
    assert_int_equal(trace_ray(&(struct job){.scene = s->scene,
                                             .packed = &s->packed,
                                             .box = box_test_find(box),
                                             .tri = tri_test_find(tri),
                                             .query = QUERY_CLOSEST},
                               &ray, &hit, counts),
                     STATUS_OK);
    return hit;
}

static inline void assert_refused(const struct subject *s, const char *text)
{
    assert_int_equal(s->status, STATUS_LIMIT);
    if (!strstr(s->reason.text, text))
        fail_msg("'%s' does not say '%s'", s->reason.text, text);
}

/* What a layout that is refused for RTRS's tree loses nothing of: `builder`, `layout`. */
static inline struct subject subject_repaired(const struct scene *scene, const char *layout)
{
    return subject_make(scene, "median", SEED_LEAF, SEED_EPS, layout);
}

/* A ray at the middle of a triangle, from 5 away along z and a little aside. */
static inline struct ray ray_at_triangle(const struct scene *scene, uint32_t prim)
{
    float v[3][3];
    struct ray ray = {.dir = {-0.5f, 0.25f, 5}, .tmax = 1000};
    scene_tri(scene, prim, v);
    for (int k = 0; k < 3; k++)
        ray.org[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 - ray.dir[k];
    return ray;
}

/* How many of the triangles first .. last are not what their ray hits. */
static inline uint32_t triangles_lost(const struct subject *s, const char *box, uint32_t first,
                                      uint32_t last)
{
    uint32_t lost = 0;
    for (uint32_t prim = first; prim <= last; prim++)
        lost += subject_hit(s, box, "mt", ray_at_triangle(s->scene, prim), NULL).prim != prim;
    return lost;
}

/* A flat square of quads x quads unit cells, two triangles each: the plane coordinate `up` = h. */
static inline struct scene flat(uint32_t quads, int up, float h)
{
    struct scene scene;
    uint32_t side = quads + 1;
    assert_int_equal(scene_make(side * side, 2 * quads * quads, &scene), STATUS_OK);
    for (uint32_t i = 0; i < side * side; i++) {
        float *p = scene.vertex + 3 * (size_t)i;
        p[up] = h;
        p[(up + 1) % 3] = (float)(i % side);
        p[(up + 2) % 3] = (float)(i / side);
    }
    uint32_t *index = scene.index;
    for (uint32_t q = 0; q < quads * quads; q++) {
        uint32_t a = q / quads * side + q % quads;
        const uint32_t corner[] = {a, a + 1, a + side + 1, a, a + side + 1, a + side};
        memcpy(index, corner, sizeof corner);
        index += 6;
    }
    return scene;
}

/* The same scene with one more triangle, far away, that no ray of these tests meets; in front or
 * behind all others. */
static inline struct scene with_a_stranger(const struct scene *scene, bool in_front)
{
    struct scene out;
    uint32_t n = scene->tri_count, v = scene->vertex_count;
    assert_int_equal(scene_make(v + 3, n + 1, &out), STATUS_OK);
    memcpy(out.vertex, scene->vertex, 12 * (size_t)v);
    memcpy(out.index + (in_front ? 3 : 0), scene->index, 12 * (size_t)n);
    for (uint32_t c = 0; c < 3; c++) {
        float *p = out.vertex + 3 * (size_t)(v + c);
        p[0] = p[1] = -1000;
        p[2] = -1000 - (float)c;
        out.index[3 * (size_t)(in_front ? 0 : n) + c] = v + c;
    }
    return out;
}

/* Makes up for F2: item k + 1 where the tree has k, so that rtrs_rf, which takes item k + 1 for
 * triangle k, tests what the tree means. The scene's last triangle is a stranger; a tree made
 * without it gets it, but in no leaf. */
static inline void compensate_f2(struct bvh *bvh, const struct scene *scene)
{
    uint32_t *prim = calloc(scene->tri_count, sizeof *prim);
    assert_non_null(prim);
    for (uint32_t i = 0; i < bvh->prim_count; i++)
        prim[i] = bvh->prim[i] + 1;
    free(bvh->prim);
    bvh->prim = prim;
    bvh->prim_count = bvh->tri_count = scene->tri_count;
}

/* The scene that RTRS ships: tests/tree/test_seed_figures.c compares it with the published file. */
static inline struct scene seed_scene(void)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open("rtrs", 1, &scene, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(scene.tri_count, 40);
    return scene;
}

#endif
