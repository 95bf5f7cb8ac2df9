/* Lives for tests: a soup of triangles, steps as text, and what comes of them. Includes
 * cmocka.h, whose macros must come last. */
#ifndef TESTS_LIVES_H
#define TESTS_LIVES_H

#include "ref/packed/life.h"
#include "ref/store.h"
#include "scenes/life_steps.h"
#include "scenes/scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* A scene's steps, and its scenes: `scene[count]` is the last. */
struct lived {
    struct scene first, scene[LIFE_STEPS_MOST + 1];
    struct step step[LIFE_STEPS_MOST];
    uint32_t count;
};

static inline struct lived lived_make(const char *spec, const char *steps)
{
    struct lived lived = {.count = 0};
    struct reason reason = {""};
    if (scene_open(spec, 3, &lived.first, &reason) ||
        (steps[0] && steps_parse(steps, lived.step, &lived.count, &reason)) ||
        steps_scenes(&lived.first, lived.step, lived.count, lived.scene, &reason))
        fail_msg("%s: %s", steps, reason.text);
    return lived;
}

static inline void lived_free(struct lived *lived)
{
    steps_free(lived->scene, lived->count);
    scene_free(&lived->first);
}

/* The tree after the last step; a layout that refuses: *out is zero. */
static inline void lived_tree(const struct lived *lived, const struct life_recipe *recipe,
                              struct life_tree *out)
{
    struct reason reason = {""};
    enum status status = life_begin(recipe, &lived->scene[0], out, &reason);
    for (uint32_t i = 0; i < lived->count && !status; i++) {
        struct life_tree before = *out;
        status = life_step(recipe, lived->step[i].act, &lived->scene[i + 1], &before, out, &reason);
        life_tree_free(&before);
    }
    if (status && status != STATUS_LIMIT)
        fail_msg("%s: %s", recipe->layout->name, reason.text);
}

static inline bool lived_same_packed(const struct packed *a, const struct packed *b)
{
    return a->word_count == b->word_count && a->item_count == b->item_count && a->root == b->root &&
           a->stack_need == b->stack_need && !a->word == !b->word &&
           (!a->word || memcmp(a->word, b->word, 4 * (size_t)a->word_count) == 0) &&
           (!a->item || memcmp(a->item, b->item, 4 * (size_t)a->item_count) == 0);
}

static inline bool lived_same_bvh(const struct bvh *a, const struct bvh *b)
{
    return a->node_count == b->node_count && a->prim_count == b->prim_count &&
           (!a->node || memcmp(a->node, b->node, a->node_count * sizeof *a->node) == 0) &&
           (!a->prim || memcmp(a->prim, b->prim, a->prim_count * sizeof *a->prim) == 0);
}

#endif
