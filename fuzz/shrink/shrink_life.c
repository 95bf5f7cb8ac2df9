/* The pass over the steps of a life: whole steps go first, then motions and seeds get plainer. */
#include "fuzz/shrink/shrink_inner.h"

#include "fuzz/play/trial_life.h"

#include <string.h>

enum {
    DROP, /* the scene that is traced stays */
    END,  /* the life ends before: the scene is what was traced then */
    STILL,
    NO_SEED,
    SEED_HALF,
    SEED_LESS,
    PLAINER, /* the motion before it in the table */
    REFIT,
    STEP_CHANGES
};

static uint32_t steps_of(const struct fuzz_trial *trial)
{
    return trial->step_count;
}

static bool drop(struct fuzz_trial *trial, uint32_t first, uint32_t count)
{
    const uint32_t behind = trial->step_count - first - count;
    memmove(&trial->step[first], &trial->step[first + count], behind * sizeof *trial->step);
    trial->step_count -= count;
    memset(&trial->step[trial->step_count], 0, count * sizeof *trial->step);
    return true;
}

static bool end(struct fuzz_trial *trial, uint32_t first, uint32_t count)
{
    struct fuzz_trial cut;
    if (count > 1 || trial_life_cut(trial, first, &cut, NULL))
        return false;
    fuzz_trial_free(trial);
    *trial = cut;
    return true;
}

static bool change_step(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    struct step *step = &trial->step[first];
    if (variant == DROP)
        return drop(trial, first, count);
    if (variant == END)
        return end(trial, first, count);
    if (count > 1)
        return false;
    switch (variant) {
    case STILL:
        step->motion = MOTION_STILL;
        step->seed = 0;
        return true;
    case NO_SEED:
        step->seed = 0;
        return true;
    case SEED_HALF:
        step->seed /= 2;
        return true;
    case SEED_LESS:
        step->seed -= step->seed > 0;
        return true;
    case PLAINER:
        step->motion -= step->motion > 0;
        return true;
    default: /* REFIT */
        step->act = LIFE_REFIT;
        return true;
    }
}

extern const struct shrink_pass shrink_steps;
const struct shrink_pass shrink_steps = {"steps", SHRINK_CHUNKS, steps_of, STEP_CHANGES,
                                         change_step};
