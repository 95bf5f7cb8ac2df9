#include "bench/frames/frames.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status frames_make(const struct frames_settings *settings, struct frames_run *out,
                        struct reason *reason)
{
    memset(out, 0, sizeof *out);
    if (settings->frames < 1 || settings->frames > FRAMES_MOST)
        return fail(reason, STATUS_INPUT, "%u frames: 1 to %u can be measured", settings->frames,
                    FRAMES_MOST);
    if (settings->warm_up > FRAMES_MOST || settings->turns > FRAMES_MOST)
        return fail(reason, STATUS_INPUT, "%u turns and %u frames to warm up: at most %u each",
                    settings->turns, settings->warm_up, FRAMES_MOST);
    out->scratch = alloc_zeroed(settings->frames, sizeof *out->scratch);
    if (!out->scratch)
        return fail(reason, STATUS_MEMORY, "no memory for %u frames", settings->frames);
    out->settings = *settings;
    return STATUS_OK;
}

enum status frames_enter(struct frames_run *run, const char *handler, uint64_t bytes,
                         struct reason *reason)
{
    if (run->count == FRAMES_CONTESTANTS)
        return fail(reason, STATUS_LIMIT, "more than %d handlers", FRAMES_CONTESTANTS);
    struct frames_contestant *c = &run->contestant[run->count];
    c->ms = alloc_zeroed(run->settings.frames, sizeof *c->ms);
    if (!c->ms)
        return fail(reason, STATUS_MEMORY, "no memory for %u frames", run->settings.frames);
    snprintf(c->handler, sizeof c->handler, "%s", handler);
    c->bytes = bytes;
    c->device_clock = true;
    run->count++;
    return STATUS_OK;
}

double frames_angle(const struct frames_settings *settings, int64_t frame)
{
    const double turn = 6.283185307179586476925;
    return turn * (double)settings->turns * (double)frame / (double)settings->frames;
}

/* Draws one frame with all contestants, starting with a different one each time, since the order
 * can matter. *drawn is false if the run was stopped before all had drawn it. */
static enum status draw_all(struct frames_run *run, int64_t frame, frames_draw *draw, void *user,
                            bool *drawn, struct reason *reason)
{
    double angle = frames_angle(&run->settings, frame);
    *drawn = false;
    for (size_t k = 0; k < run->count; k++) {
        size_t i = (k + (frame < 0 ? 0 : (size_t)frame)) % run->count;
        struct frames_contestant *c = &run->contestant[i];
        struct frames_sample sample = {0};
        if (run->settings.stop && *run->settings.stop)
            return STATUS_OK;
        enum status status = draw(user, i, angle, &sample, reason);
        if (status)
            return status;
        c->device_clock = c->device_clock && sample.device_clock;
        if (frame >= 0)
            c->ms[frame] = sample.ms;
    }
    *drawn = true;
    return STATUS_OK;
}

static enum status draw_frames(struct frames_run *run, frames_draw *draw, frames_tell *tell,
                               void *user, struct reason *reason)
{
    enum status status = STATUS_OK;
    int64_t warm_up = (int64_t)run->settings.warm_up;
    for (int64_t frame = -warm_up; frame < (int64_t)run->settings.frames && !status; frame++) {
        bool drawn;
        status = draw_all(run, frame, draw, user, &drawn, reason);
        if (status)
            break;
        if (!drawn) {
            run->stopped = true;
            break;
        }
        run->dropped += frame < 0;
        run->done += frame >= 0;
        if (tell && frame >= 0 && run->done % FRAMES_REWRITE == 0 &&
            run->done < run->settings.frames)
            status = tell(user, run, reason);
    }
    return status;
}

enum status frames_measure(struct frames_run *run, frames_draw *draw, frames_tell *tell, void *user,
                           struct reason *reason)
{
    enum status status = draw_frames(run, draw, tell, user, reason);
    if (!tell)
        return status;
    struct reason other;
    enum status told = tell(user, run, status ? &other : reason);
    return status ? status : told;
}

void frames_free(struct frames_run *run)
{
    for (size_t i = 0; i < run->count; i++)
        free(run->contestant[i].ms);
    free(run->scratch);
    memset(run, 0, sizeof *run);
}

struct frames_stats frames_stats_of(const struct frames_run *run, size_t contestant)
{
    const double *ms = run->contestant[contestant].ms;
    if (run->done == 0)
        return (struct frames_stats){0};
    double sum = 0;
    for (uint32_t i = 0; i < run->done; i++)
        sum += run->scratch[i] = ms[i];
    struct spread spread = spread_of(run->scratch, run->done);
    return (struct frames_stats){sum / (double)run->done, spread.least, spread.most, spread.median};
}

struct spread frames_ratio(const struct frames_run *run, size_t a, size_t b)
{
    if (run->done == 0)
        return (struct spread){0};
    for (uint32_t i = 0; i < run->done; i++)
        run->scratch[i] = run->contestant[a].ms[i] / run->contestant[b].ms[i];
    return spread_of(run->scratch, run->done);
}
