/* Lives of worlds for tests: a world, steps as text, and what comes of them. Includes cmocka.h,
 * whose macros must come last. */
#ifndef TESTS_WORLD_LIVES_H
#define TESTS_WORLD_LIVES_H

#include "ref/store.h"
#include "ref/two_level/world_check.h"
#include "ref/two_level/world_life.h"
#include "scenes/world_steps.h"
#include "scenes/worlds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* A world's steps, and its worlds: `world[count]` is the last. */
struct world_lived {
    struct world first, world[LIFE_STEPS_MOST + 1];
    struct step step[LIFE_STEPS_MOST];
    uint32_t count;
};

static inline struct world_lived *world_lived_make(const char *spec, const char *steps)
{
    struct world_lived *lived = calloc(1, sizeof *lived);
    struct reason reason = {""};
    assert_non_null(lived);
    if (world_open(spec, 3, &lived->first, &reason) ||
        (steps[0] && steps_parse(steps, lived->step, &lived->count, &reason)) ||
        steps_worlds(&lived->first, lived->step, lived->count, lived->world, &reason))
        fail_msg("%s: %s", steps, reason.text);
    return lived;
}

static inline void world_lived_free(struct world_lived *lived)
{
    steps_worlds_free(lived->world, lived->count);
    world_free(&lived->first);
    free(lived);
}

/* The trees after the last step; where a layout refuses, *out is zero. */
static inline void world_lived_trees(const struct world_lived *lived,
                                     const struct world_recipe *recipe, struct world_life *out)
{
    struct reason reason = {""};
    enum status status = world_life_begin(recipe, &lived->world[0], out, &reason);
    for (uint32_t i = 0; i < lived->count && !status; i++) {
        struct world_life before = *out;
        status = world_life_step(recipe, lived->step[i].act, &lived->world[i + 1], &before, out,
                                 &reason);
        world_life_free(&before);
    }
    if (status && status != STATUS_LIMIT)
        fail_msg("%s: %s", recipe->bottom->name, reason.text);
}

static inline bool same_words(const struct packed *a, const struct packed *b)
{
    return a->word_count == b->word_count && a->item_count == b->item_count && a->root == b->root &&
           a->stack_need == b->stack_need && !a->word == !b->word &&
           (!a->word || memcmp(a->word, b->word, 4 * (size_t)a->word_count) == 0) &&
           (!a->item || memcmp(a->item, b->item, 4 * (size_t)a->item_count) == 0);
}

static inline bool same_packed_worlds(const struct packed_world *a, const struct packed_world *b)
{
    bool same = a->entry_count == b->entry_count && a->tree_count == b->tree_count &&
                a->stack_need == b->stack_need && a->split == b->split &&
                same_words(&a->top, &b->top);
    for (uint32_t i = 0; i < a->tree_count && same; i++)
        same = same_words(&a->bottom[i], &b->bottom[i]) && a->mesh[i] == b->mesh[i];
    for (uint32_t i = 0; i < a->entry_count && same; i++)
        same = memcmp(&a->record[i], &b->record[i], sizeof *a->record) == 0 &&
               memcmp(&a->box[i], &b->box[i], sizeof *a->box) == 0;
    return same;
}

/* Steps of all kinds, that leave something to hit in the end. */
static const char *const world_lived_steps[] = {
    "refit:drift:2",
    "refit:turn:1,refit:drift:5",
    "refit:reflect:1,refit:scale:2",
    "refit:exchange:7,refit:masks:3",
    "refit:hide:2,refit:turn:3,refit:hide:5,refit:drift:4",
    "refit:jitter:3,refit:mirror:1",
    "rebuild:away:3,refit:drift:4,refit:swap:6",
    "refit:gather:1,refit:turn:2,refit:drift:3",
    "refit,rebuild,refit",
};

#endif
