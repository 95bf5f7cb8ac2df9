/* What the suites of the fuzzer's generators share. Include after cmocka.h. */
#ifndef TESTS_FUZZ_GEN_TRIALS_H
#define TESTS_FUZZ_GEN_TRIALS_H

#include "fuzz/gen/gen.h"

#include <string.h>

static const struct gen_options ordinary = {
    .triangles_least = 16, .triangles_most = 64, .rays = 500};

typedef enum status gen_fn(uint64_t seed, uint64_t index, const struct gen_options *options,
                           struct fuzz_trial *out, struct reason *reason);

static inline struct fuzz_trial trial_of(uint64_t seed, uint64_t index,
                                         const struct gen_options *options)
{
    struct fuzz_trial trial;
    struct reason reason = {""};
    if (gen_trial(seed, index, options, &trial, &reason))
        fail_msg("trial %llu: %s", (unsigned long long)index, reason.text);
    return trial;
}

/* Whether the trial was made by that recipe. */
static inline bool is_recipe(const struct fuzz_trial *trial, const char *name)
{
    size_t length = strlen(name);
    const char *recipe = trial->origin.recipe;
    return strncmp(recipe, name, length) == 0 && (recipe[length] == '\0' || recipe[length] == ' ');
}

#endif
