#include "fuzz/gen/mutate_inner.h"

#include "ref/oracle/environment.h"

#include <string.h>

#define EDIT(id, part_) static const struct edit id = {#id, part_, edit_##id}
EDIT(snap, EDIT_SCENE);
EDIT(scale, EDIT_SCENE);
EDIT(move, EDIT_SCENE);
EDIT(negate, EDIT_SCENE);
EDIT(swap_axes, EDIT_SCENE);
EDIT(flatten, EDIT_SCENE);
EDIT(halves, EDIT_SCENE);
EDIT(next_float, EDIT_SCENE);
EDIT(onto_vertex, EDIT_SCENE);
EDIT(onto_edge, EDIT_SCENE);
EDIT(zero, EDIT_SCENE);
EDIT(far_vertex, EDIT_SCENE);
EDIT(duplicate, EDIT_SCENE);
EDIT(permute, EDIT_SCENE);
EDIT(turn, EDIT_SCENE);
EDIT(weld, EDIT_SCENE);
EDIT(unweld, EDIT_SCENE);
EDIT(drop, EDIT_SCENE);
EDIT(aim, EDIT_RAYS);
EDIT(ray_step, EDIT_RAYS);
EDIT(ray_axis, EDIT_RAYS);
EDIT(ray_range, EDIT_RAYS);
EDIT(ray_back, EDIT_RAYS);
EDIT(ray_scale, EDIT_RAYS);
EDIT(leaf, EDIT_TESTS);
EDIT(builder, EDIT_TESTS);
EDIT(box, EDIT_TESTS);
EDIT(tri, EDIT_TESTS);
EDIT(query, EDIT_TESTS);
EDIT(refit, EDIT_TESTS);

const struct edit *const edits[] = {
    &snap,        &scale,     &move, &negate,     &swap_axes, &flatten,   &halves,   &next_float,
    &onto_vertex, &onto_edge, &zero, &far_vertex, &duplicate, &permute,   &turn,     &weld,
    &unweld,      &drop,      &aim,  &ray_step,   &ray_axis,  &ray_range, &ray_back, &ray_scale,
    &leaf,        &builder,   &box,  &tri,        &query,     &refit,     NULL,
};

static const struct edit *choose_edit(struct rng *rng, enum edit_part part)
{
    uint32_t fitting = 0;
    for (size_t i = 0; edits[i]; i++)
        fitting += part == EDIT_PARTS || edits[i]->part == part;
    uint32_t skip = rng_below(rng, fitting);
    for (size_t i = 0;; i++)
        if ((part == EDIT_PARTS || edits[i]->part == part) && skip-- == 0)
            return edits[i];
}

/* " + name", cut where the text is full. */
static void note(struct fuzz_trial *trial, const char *name)
{
    char *text = trial->origin.recipe;
    size_t room = sizeof trial->origin.recipe - strlen(text) - 1;
    strncat(text, " + ", room);
    room = sizeof trial->origin.recipe - strlen(text) - 1;
    strncat(text, name, room);
}

enum status mutate_once(struct rng *rng, struct fuzz_trial *trial, enum edit_part part,
                        struct reason *reason)
{
    for (int tries = 0; tries < 32; tries++) {
        const struct edit *edit = choose_edit(rng, part);
        bool changed = false;
        if (edit->apply(rng, trial, &changed))
            return fail(reason, STATUS_MEMORY, "no memory to edit a trial");
        if (changed) {
            note(trial, edit->name);
            break;
        }
    }
    return STATUS_OK;
}

enum status gen_mutate(struct rng *rng, struct fuzz_trial *trial, struct reason *reason)
{
    unsigned long environment = environment_enter();
    enum status status = mutate_once(rng, trial, EDIT_PARTS, reason);
    environment_leave(environment);
    if (!status)
        trial->origin.mutated = true;
    return status;
}
