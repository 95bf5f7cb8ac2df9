/* Scenes, their binary trees and the dual-split trees of these; and a walk with implied boxes that
 * shares nothing with ref/dual but the numbers of the packing. */
#ifndef TESTS_DUAL_FIXTURE_H
#define TESTS_DUAL_FIXTURE_H

#include "ref/dual/dual.h"
#include "scenes/scenes.h"
#include "tests/support/built.h"

#define DUAL_NAMED  6u
#define DUAL_SHAPED 5u
#define DUAL_SCENES (BUILT_SCENES + DUAL_NAMED + DUAL_SHAPED)

struct dual_stand {
    const char *what;
    struct scene scene;
    struct bvh bvh;
    struct packed packed; /* f32 */
    struct dual_tree tree;
};

static inline void dual_stand_pack(struct dual_stand *s, enum dual_carving carving)
{
    struct reason reason = {""};
    if (packed_make(layout_find("f32"), &s->bvh, &s->scene, &s->packed, &reason) ||
        dual_make(&s->packed, carving, &s->tree, &reason))
        fail_msg("%s: %s", s->what, reason.text);
}

/* The tree of a scene; of few triangles each is a leaf. */
static inline void dual_stand_of(struct dual_stand *s, struct scene scene, const char *builder,
                                 enum dual_carving carving)
{
    const struct build_options options = {.leaf = scene.tri_count < 16 ? 1 : 3,
                                          .eps = BUILD_EPS_DEFAULT};
    struct reason reason = {""};
    s->scene = scene;
    if (bvh_build(builder_find(builder), &s->scene, &options, &s->bvh, &reason))
        fail_msg("%s: %s", s->what, reason.text);
    dual_stand_pack(s, carving);
}

/* One triangle, two, and trees as deep as a stack allows, to either side. */
static inline void dual_stand_shaped(struct dual_stand *s, size_t i, enum dual_carving carving)
{
    static const char *const name[] = {"one", "two", "two in one leaf", "deep left", "deep right"};
    static const uint32_t tris[] = {1, 2, 2, DUAL_DEPTH_MOST + 1, DUAL_DEPTH_MOST + 1};
    s->what = name[i];
    s->scene = i < 3 ? built_soup(tris[i], 9) : trees_row(tris[i]);
    s->bvh = trees_make(&s->scene, i == 2 ? 2 : 1, i == 3 ? TREES_LEFT : TREES_RIGHT);
    dual_stand_pack(s, carving);
}

static inline void dual_stand_make(struct dual_stand *s, size_t i, enum dual_carving carving)
{
    static const char *const spec[DUAL_NAMED] = {"needles:n=300", "grid:n=12", "cornell",
                                                 "sphere:n=12",   "stack",     "flake:n=2"};
    static const char *const by[] = {"median", "sah_binned", "lbvh", "ploc"};
    struct scene scene = {0};
    struct reason reason = {""};
    if (i >= BUILT_SCENES + DUAL_NAMED) {
        dual_stand_shaped(s, i - BUILT_SCENES - DUAL_NAMED, carving);
        return;
    }
    s->what = i < BUILT_SCENES ? NULL : spec[i - BUILT_SCENES];
    if (i < BUILT_SCENES)
        scene = built_scene(i, &s->what);
    else if (scene_open(s->what, 1, &scene, &reason))
        fail_msg("%s: %s", s->what, reason.text);
    dual_stand_of(s, scene, by[i % ARRAY_COUNT(by)], carving);
}

static inline void dual_stand_free(struct dual_stand *s)
{
    dual_free(&s->tree);
    packed_free(&s->packed);
    bvh_free(&s->bvh);
    scene_free(&s->scene);
}

/* What a word says of its node. */
enum dual_kind { DUAL_IS_SPLIT, DUAL_IS_CARVE, DUAL_IS_LEAF };

struct dual_seen {
    enum dual_kind kind;
    uint32_t at, next; /* its word; of the upper child, or behind a leaf */
    uint32_t side[2];  /* whose planes are `plane`: of a split the lower child's, the upper one's */
    float plane[2];
    uint32_t first, count; /* of a leaf */
};

static inline struct dual_seen dual_look(const struct dual_tree *tree, uint32_t at)
{
    assert_true(at + 2 <= tree->word_count);
    const uint32_t *word = tree->word + at, head = word[0];
    struct dual_seen seen = {.kind = DUAL_IS_LEAF, .at = at, .next = at + 2, .count = head / 8};
    if (head % 8 == 3) {
        seen.first = word[1];
        return seen;
    }
    assert_true(at + 3 <= tree->word_count);
    seen.kind = head % 4 == 3 ? DUAL_IS_CARVE : DUAL_IS_SPLIT;
    seen.side[0] = seen.kind == DUAL_IS_SPLIT ? 3 + head % 4 : head / 8 % 8;
    seen.side[1] = seen.kind == DUAL_IS_SPLIT ? head % 4 : head / 64;
    seen.next = seen.kind == DUAL_IS_SPLIT ? head / 4 : at + 3;
    for (int i = 0; i < 2; i++)
        memcpy(&seen.plane[i], &word[1 + i], sizeof(float));
    assert_true(seen.side[0] < 6 && seen.side[1] < 6);
    return seen;
}

static inline float dual_bound(const struct box *box, uint32_t side)
{
    return side < 3 ? box->lo[side] : box->hi[side - 3];
}

/* `box` with that side moved. */
static inline struct box dual_cut(struct box box, uint32_t side, float plane)
{
    *(side < 3 ? &box.lo[side] : &box.hi[side - 3]) = plane;
    return box;
}

#endif
