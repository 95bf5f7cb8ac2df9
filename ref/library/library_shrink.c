/* The public library: the smallest failing case, by the shrinker of campaigns. What a trial has
 * besides triangles and a ray stays as fuzz_trial_make sets it, which is the smallest. */
#include "ref/library/library.h"

#include "fuzz/shrink/shrink.h"

#include <stdlib.h>
#include <string.h>

struct raydiff_small {
    struct fuzz_trial trial; /* of one ray */
};

struct library_asking {
    raydiff_fails *fails;
    void *user;
    unsigned long modes; /* the caller's, in which `fails` runs */
};

static struct raydiff_case case_of(const struct fuzz_trial *trial)
{
    return (struct raydiff_case){.vertex = trial->scene.vertex,
                                 .index = trial->scene.index,
                                 .vertex_count = trial->scene.vertex_count,
                                 .triangle_count = trial->scene.tri_count,
                                 .ray = (const float *)(const void *)trial->ray};
}

/* A shrink_ask_fn. */
static enum status ask(void *user, const struct fuzz_trial *candidate, size_t count, size_t *first,
                       struct reason *reason)
{
    const struct library_asking *asking = user;
    *first = count;
    for (size_t i = 0; i < count; i++) {
        if (candidate[i].ray_count != 1)
            continue;
        const struct raydiff_case what = case_of(&candidate[i]);
        const unsigned long modes = float_mode();
        library_modes(asking->modes);
        const int fails = asking->fails(asking->user, &what);
        library_modes(modes);
        if (fails < 0)
            return fail(reason, STATUS_REFUSED, "the callback ended the shrinking");
        if (fails > 0) {
            *first = i;
            return STATUS_OK;
        }
    }
    return STATUS_OK;
}

/* A trial of the case, which owns copies. */
static enum status trial_of(const struct raydiff_case *what, struct fuzz_trial *out,
                            struct reason *reason)
{
    struct scene scene;
    enum status status = library_scene(what, &scene, reason);
    if (status)
        return status;
    status = fuzz_trial_make(what->vertex_count, what->triangle_count, 1, out, reason);
    if (status) {
        scene_free(&scene);
        return status;
    }
    scene_free(&out->scene);
    out->scene = scene;
    memcpy(out->ray, what->ray, sizeof *out->ray);
    return STATUS_OK;
}

static enum status shrink(const struct raydiff_case *what, struct library_asking *asking,
                          uint64_t calls, struct raydiff_small *out, struct reason *reason)
{
    const struct shrink_options options = {.asks = calls};
    struct shrink_stats stats;
    struct fuzz_trial trial = {0};
    enum status status = library_given(what, "what", reason);
    if (!status)
        status = library_given(asking->fails ? what : NULL, "fails", reason);
    if (!status)
        status = library_given(what->ray, "ray", reason);
    if (!status)
        status = trial_of(what, &trial, reason);
    if (!status)
        status = fuzz_shrink_trial(&trial, ask, asking, &options, &out->trial, &stats, reason);
    fuzz_trial_free(&trial);
    return status;
}

enum raydiff_error raydiff_shrink(const struct raydiff_case *what, raydiff_fails *fails, void *user,
                                  uint64_t calls, struct raydiff_small **out,
                                  struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct library_asking asking = {fails, user, modes};
    struct reason reason = {""};
    enum status status = library_given(out, "out", &reason);
    if (status)
        return library_end(modes, status, &reason, why);
    *out = NULL;
    struct raydiff_small *small = alloc_zeroed(1, sizeof *small);
    status = small ? shrink(what, &asking, calls, small, &reason)
                   : fail(&reason, STATUS_MEMORY, "no memory to shrink");
    if (status)
        raydiff_small_free(small);
    else
        *out = small;
    return library_end(modes, status, &reason, why);
}

struct raydiff_case raydiff_small_case(const struct raydiff_small *small)
{
    return case_of(&small->trial);
}

void raydiff_small_free(struct raydiff_small *small)
{
    if (!small)
        return;
    fuzz_trial_free(&small->trial);
    free(small);
}
