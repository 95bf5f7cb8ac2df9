/* Trials of worlds and players of them. Includes cmocka.h, whose macros must come last. */
#ifndef TWO_LEVEL_FUZZ_WORLD_PLAY_H
#define TWO_LEVEL_FUZZ_WORLD_PLAY_H

#include "fuzz/gen/gen.h"
#include "fuzz/play/player.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

static const struct gen_options of_worlds = {
    .triangles_least = 16, .triangles_most = 40, .rays = 150, .worlds = true};

static inline void make_trial(uint64_t seed, uint64_t index, const struct gen_options *options,
                              struct fuzz_trial *out)
{
    struct reason reason = {""};
    if (gen_trial(seed, index, options, out, &reason))
        fail_msg("%s", reason.text);
}

static inline struct fuzz_trial trial_of(uint64_t seed, uint64_t index,
                                         const struct gen_options *options)
{
    struct fuzz_trial trial;
    make_trial(seed, index, options, &trial);
    return trial;
}

/* Whether the trial was made by that recipe. */
static inline bool is_recipe(const struct fuzz_trial *trial, const char *name)
{
    size_t length = strlen(name);
    const char *recipe = trial->origin.recipe;
    return strncmp(recipe, name, length) == 0 && (recipe[length] == '\0' || recipe[length] == ' ');
}

static inline struct fuzz_player *open_all(const struct engine *const *engine, size_t engines_count,
                                           const struct layout *const *layout, size_t layouts_count)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    struct fuzz_field field;
    struct fuzz_player *player;
    if (fuzz_field_make(engine, engines_count, layout, layouts_count, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

static inline void must_play(struct fuzz_player *player, const struct fuzz_trial *trial,
                             size_t count, struct fuzz_result *result)
{
    struct reason reason = {""};
    if (fuzz_play(player, trial, count, result, NULL, NULL, &reason))
        fail_msg("%s", reason.text);
}

#endif
