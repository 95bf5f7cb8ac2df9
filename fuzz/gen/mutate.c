#include "fuzz/gen/mutate_inner.h"

#include "fuzz/gen/gen_world.h"
#include "ref/oracle/environment.h"

#include <string.h>

const struct edit edits[] = {
    {"snap", EDIT_SCENE, edit_snap},
    {"scale", EDIT_SCENE, edit_scale},
    {"move", EDIT_SCENE, edit_move},
    {"negate", EDIT_SCENE, edit_negate},
    {"swap_axes", EDIT_SCENE, edit_swap_axes},
    {"flatten", EDIT_SCENE, edit_flatten},
    {"halves", EDIT_SCENE, edit_halves},
    {"next_float", EDIT_SCENE, edit_next_float},
    {"onto_vertex", EDIT_SCENE, edit_onto_vertex},
    {"onto_edge", EDIT_SCENE, edit_onto_edge},
    {"zero", EDIT_SCENE, edit_zero},
    {"far_vertex", EDIT_SCENE, edit_far_vertex},
    {"duplicate", EDIT_SCENE, edit_duplicate},
    {"permute", EDIT_SCENE, edit_permute},
    {"turn", EDIT_SCENE, edit_turn},
    {"weld", EDIT_SCENE, edit_weld},
    {"unweld", EDIT_SCENE, edit_unweld},
    {"drop", EDIT_SCENE, edit_drop},
    {"aim", EDIT_RAYS, edit_aim},
    {"ray_step", EDIT_RAYS, edit_ray_step},
    {"ray_axis", EDIT_RAYS, edit_ray_axis},
    {"ray_range", EDIT_RAYS, edit_ray_range},
    {"ray_back", EDIT_RAYS, edit_ray_back},
    {"ray_scale", EDIT_RAYS, edit_ray_scale},
    {"leaf", EDIT_TESTS, edit_leaf},
    {"builder", EDIT_TESTS, edit_builder},
    {"box", EDIT_TESTS, edit_box},
    {"tri", EDIT_TESTS, edit_tri},
    {"query", EDIT_TESTS, edit_query},
    {"refit", EDIT_TESTS, edit_refit},
    {.name = NULL},
};

static const struct edit *choose_edit(struct rng *rng, enum edit_part part)
{
    uint32_t fitting = 0;
    for (size_t i = 0; edits[i].name; i++)
        fitting += part == EDIT_PARTS || edits[i].part == part;
    uint32_t skip = rng_below(rng, fitting);
    for (size_t i = 0;; i++)
        if ((part == EDIT_PARTS || edits[i].part == part) && skip-- == 0)
            return &edits[i];
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
        const char *name = NULL;
        bool changed = false;
        enum status status;
        if (trial->world.is && rng_below(rng, 3) > 0) { /* most of what is new is there */
            status = gen_world_edit(rng, trial, &changed, &name);
        } else {
            const struct edit *edit = choose_edit(rng, part);
            name = edit->name;
            status = edit->apply(rng, trial, &changed);
            gen_world_settle(trial);
        }
        if (status)
            return fail(reason, STATUS_MEMORY, "no memory to edit a trial");
        if (changed) {
            note(trial, name);
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
