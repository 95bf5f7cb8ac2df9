#include "fuzz/findings/finding_file.h"
#include "tests/truth/truth.h"
#include "tests/truth/world_play.h"

#include <stdlib.h>
#include <string.h>

/* Prints what is WRONG in one finding, each kind with the opinions on it. */
static void print_kinds(const char *path, const struct tally *tally)
{
    if (tally->count == 0)
        printf("%s: nothing wrong\n", path);
    for (size_t i = 0; i < tally->count; i++) {
        const struct signature *s = &tally->signature[i];
        printf("%s: %s %s: %zu wrong, confirmed %zu, open %zu, overturned %zu\n", path,
               s->first.who.engine->name, wrong_name(s->first.judgement.wrong), s->count,
               s->opinion[GMP_CONFIRMED], s->opinion[GMP_OPEN], s->opinion[GMP_OVERTURNED]);
    }
}

/* Adds the answers of one finding to those of the campaign. */
static void join(struct tally *to, const struct tally *from)
{
    for (size_t i = 0; i < from->count; i++)
        for (int k = 0; k < GMP_OPINION_COUNT; k++)
            for (size_t n = 0; n < from->signature[i].opinion[k]; n++) {
                struct wrong_answer wrong = from->signature[i].first;
                wrong.opinion = (enum gmp_opinion)k;
                (void)tally_add(to, &wrong);
            }
}

static enum status play_ground(struct truth_campaign *c, struct world_ground *ground,
                               const struct tally_contestant *who, struct reason *reason)
{
    struct tally *tally = calloc(1, sizeof *tally); /* too large for the stack */
    struct play_result result;
    enum status status =
        tally ? oracle_closest_world(ground->oracle, ORACLE_AUTO, ORACLE_CLOSED, ground->ray,
                                     ground->mode, ground->count, 0, ground->truth, NULL, reason)
              : STATUS_MEMORY;
    if (!status) {
        status = world_play(ground, who, &c->pool, tally, &result, reason);
        truth_count(c, ground->spec, who, who->layout ? GROUP_MT : GROUP_OTHERS, status, &result,
                    reason);
        if (!status && result.refused) {
            printf("%s: %s cannot play it here\n", ground->spec, who->engine->name);
            c->code = exit_worse(c->code, EXIT_SKIPPED);
        } else if (!status)
            print_kinds(ground->spec, tally);
        join(&c->tally, tally);
        status = STATUS_OK; /* counted */
    }
    free(tally);
    return status;
}

enum status truth_play_trial(struct truth_campaign *c, const char *spec, struct reason *reason)
{
    struct finding_file file;
    struct trial_meshes meshes;
    enum status status = finding_file_read(spec, &file, reason);
    if (status)
        return status;
    const struct engine *engine =
        file.has_signature ? fuzz_signature_engine(&file.signature) : NULL;
    if (!file.trial.world.is || !engine)
        status = fail(reason, STATUS_INPUT, "%s",
                      engine ? "is of a scene, not of a world" : "names no engine");
    if (!status)
        status = trial_meshes_make(&file.trial.world, &file.trial.scene, &meshes, reason);
    if (!status) {
        struct world_ground ground = {.spec = spec,
                                      .rays = "its own",
                                      .world = meshes.world,
                                      .ray = file.trial.ray,
                                      .mode = file.trial.world.mode,
                                      .count = file.trial.ray_count,
                                      .query = file.trial.query};
        const struct tally_contestant who = {.engine = engine,
                                             .layout = file.signature.layout,
                                             .box = file.trial.box,
                                             .tri = file.trial.tri};
        status =
            world_ground_make(&ground, ground.count, file.trial.builder, &file.trial.build, reason);
        if (!status)
            status = play_ground(c, &ground, &who, reason);
        ground.world = (struct world){.borrows = true}; /* the trial's */
        world_ground_free(&ground);
        trial_meshes_free(&meshes);
    }
    fuzz_trial_free(&file.trial);
    return status;
}
