/* Packed trees at the borders of what a layout can hold. Include after cmocka.h. */
#ifndef TESTS_HELD_H
#define TESTS_HELD_H

#include "tests/support/tree_fixture.h"
#include "ref/packed/packed_check.h"
#include "ref/store.h"

#include <string.h>

/* A scene, its tree and one packed form. */
struct held {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct reason reason;
    enum status status;
};

static inline struct held hold(const char *layout, struct scene scene, uint32_t leaf,
                               enum trees_shape shape)
{
    struct held h = {.scene = scene, .bvh = trees_make(&scene, leaf, shape)};
    h.status = packed_make(layout_find(layout), &h.bvh, &h.scene, &h.packed, &h.reason);
    if (h.status)
        assert_null(h.packed.word);
    return h;
}

/* As hold, but a tree may be deeper than any stack: only the words are wanted. */
static inline struct held hold_words(const char *layout, struct scene scene, uint32_t leaf,
                                     enum trees_shape shape)
{
    struct held h = {
        .scene = scene, .bvh = trees_make(&scene, leaf, shape), .packed = {.store = tri_stores[0]}};
    h.status =
        layout_find(layout)->pack(layout_find(layout), &h.bvh, &h.scene, &h.packed, &h.reason);
    h.packed.layout = layout_find(layout);
    h.packed.tri_count = h.scene.tri_count;
    return h;
}

static inline void release(struct held *h)
{
    packed_free(&h->packed);
    bvh_free(&h->bvh);
    scene_free(&h->scene);
}

static inline void must_hold(struct held h, bool sound)
{
    if (h.status)
        fail_msg("%s", h.reason.text);
    struct reason reason = {""};
    if (sound && packed_check(&h.packed, &h.scene, NULL, &reason))
        fail_msg("%s", reason.text);
    release(&h);
}

static inline void must_refuse(struct held h, const char *text)
{
    assert_int_equal(h.status, STATUS_LIMIT);
    if (!strstr(h.reason.text, text))
        fail_msg("'%s' does not say '%s'", h.reason.text, text);
    release(&h);
}

/* Triangle in slot `s` of the leaf whose record is `record`. */
static inline uint32_t slot(const struct packed *packed, uint32_t record, uint32_t s)
{
    struct wide node;
    packed->layout->load(packed, record, &node);
    assert_int_equal(node.child_count, 0);
    return s < node.item_count ? packed_item(packed, &node, s) : ABI_NO_PRIM;
}

/* Two triangles, the second with its coordinate `k` of vertex 1 at `x`. */
static inline struct scene reaching(float x, int k)
{
    struct scene scene = trees_grid(2);
    scene.vertex[12 + k] = x;
    return scene;
}

#endif
