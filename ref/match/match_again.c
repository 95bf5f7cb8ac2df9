/* An engine that is wrong after steps, prepared anew: if it then is right, its update is at fault.
 */
#include "ref/match/match_engine.h"
#include "ref/match/match_judge.h"

#include <stdlib.h>
#include <string.h>

/* Traces with the fresh engine and judges; errors of the engine leave the row as it is. */
static enum status judge_again(const struct match *match, const struct engine *engine, void *self,
                               struct row *row, struct reason *reason)
{
    struct match other = *match;
    struct trace_report report = {0};
    struct row *fresh = alloc_zeroed(1, sizeof *fresh);
    other.answer = alloc_zeroed(row->rays, sizeof *other.answer);
    other.answer_tag = alloc_zeroed(row->rays, sizeof *other.answer_tag);
    enum status status = fresh && other.answer && other.answer_tag
                             ? STATUS_OK
                             : fail(reason, STATUS_MEMORY, "no memory for %zu rays", row->rays);
    if (!status && match_trace(match, engine, self, row->rays, other.answer, other.answer_tag,
                               &report, reason) == STATUS_OK) {
        const struct model model = match_model(&other, engine, self, fresh);
        fresh->engine = engine;
        fresh->layout = row->layout;
        fresh->options = row->options;
        fresh->rays = row->rays;
        status = match_judge(&other, &model, fresh);
        row->life.again = status == STATUS_OK;
        row->life.wrong_again = fresh->count[VERDICT_WRONG];
    }
    free(other.answer);
    free(other.answer_tag);
    free(fresh);
    return status;
}

enum status match_again(const struct match *match, const struct engine *engine, struct row *row)
{
    struct reason reason = {""};
    void *self = NULL;
    if (row->count[VERDICT_WRONG] == 0 || !match->options.life || match->options.life->count == 0 ||
        match->options.query == QUERY_ALL)
        return STATUS_OK;
    const struct job job = match_job(match, engine);
    const struct world_job world = match_world_job(match, engine);
    enum status status = engine_open(engine, &match->pool->options, &self, &reason);
    if (!status)
        status = match->world ? engine->worlds->prepare_world(self, &world, &reason)
                              : engine->prepare(self, &job, &reason);
    if (status == STATUS_OK)
        status = judge_again(match, engine, self, row, &reason);
    else
        status = status == STATUS_MEMORY ? status : STATUS_OK;
    if (self && engine->close)
        engine->close(self);
    return status ? fail(&row->reason, status, "%s", reason.text) : STATUS_OK;
}
