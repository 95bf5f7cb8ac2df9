/* Scenes whose vertices have moved, and packed trees before they are refitted. Include after
 * cmocka.h. */
#ifndef TESTS_MOVED_H
#define TESTS_MOVED_H

#include "ref/packed/refit.h"
#include "scenes/move.h"
#include "tests/support/built.h"

#include <stdlib.h>

static void translate(struct scene *scene, float by)
{
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        scene->vertex[i] += by;
}

/* About the middle of the soup, which is 0. */
static inline void scale(struct scene *scene, float by)
{
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        scene->vertex[i] *= by;
}

enum motion { STILL, SMALL, LARGE, POINT, GROWN, EXPLODED, NEAR, FAR, BEYOND_HALVES, MOTIONS };

static inline struct scene moved_by(const struct scene *scene, enum motion motion, uint64_t seed)
{
    struct scene moved;
    assert_int_equal(scene_make(scene->vertex_count, scene->tri_count, &moved), STATUS_OK);
    memcpy(moved.index, scene->index, 3 * (size_t)scene->tri_count * sizeof *moved.index);
    memcpy(moved.vertex, scene->vertex, 3 * (size_t)scene->vertex_count * sizeof *moved.vertex);
    switch (motion) {
    case SMALL:
        scene_move(&moved, 0.01f, seed);
        break;
    case LARGE:
        scene_move(&moved, 0.7f, seed);
        break;
    case POINT:
        scale(&moved, 0);
        break;
    case GROWN:
        scale(&moved, 3);
        break;
    case EXPLODED:
        scale(&moved, 1e36f);
        break;
    case NEAR:
        scale(&moved, 0.5f);
        translate(&moved, 2.25f);
        break;
    case FAR:
        translate(&moved, 3e7f);
        break;
    case BEYOND_HALVES:
        translate(&moved, 70000);
        break;
    default:
        break;
    }
    return moved;
}

struct snapshot {
    uint32_t *word, *item;
};

static inline uint32_t *copied(const uint32_t *word, size_t count)
{
    uint32_t *copy = calloc(count + 1, sizeof *copy);
    assert_non_null(copy);
    if (count)
        memcpy(copy, word, count * sizeof *copy);
    return copy;
}

static inline struct snapshot snapshot(const struct packed *packed)
{
    return (struct snapshot){copied(packed->word, packed->word_count),
                             copied(packed->item, packed->item ? packed->item_count : 0)};
}

static inline void drop(struct snapshot *shot)
{
    free(shot->word);
    free(shot->item);
}

static inline bool same_as(const struct packed *packed, const struct snapshot *shot)
{
    return memcmp(packed->word, shot->word, packed->word_count * sizeof *shot->word) == 0 &&
           (!packed->item ||
            memcmp(packed->item, shot->item, packed->item_count * sizeof *shot->item) == 0);
}

#endif
