/* Engine `webgpu`: traces with the WGSL of shaders/wgsl/, which Dawn runs in its own process. */
#include "gpu/trace/dispatch.h"
#include "gpu/webgpu/webgpu_card.h"
#include "gpu/webgpu/webgpu_job.h"
#include "ref/base/text.h"
#include "ref/twin/twin.h"

#include <stdlib.h>

/* Rays of one request, and so of one dispatch, at most. */
#define RAYS_MOST ((size_t)1 << 16)

struct webgpu {
    struct webgpu_peer peer;
    struct webgpu_answer *answer; /* room for RAYS_MOST */
    uint32_t tri_count;
    uint64_t bytes; /* of the buffers */
    bool prepared;
};

static void close(void *self)
{
    struct webgpu *w = self;
    if (!w)
        return;
    webgpu_stop(&w->peer);
    free(w->answer);
    free(w);
}

static enum status open(const struct engine *engine, const struct engine_options *options,
                        void **self, struct reason *reason)
{
    (void)engine;
    struct webgpu *w = alloc_zeroed(1, sizeof *w);
    *self = NULL;
    if (w)
        w->answer = alloc_zeroed(RAYS_MOST, sizeof *w->answer);
    enum status status = w && w->answer
                             ? webgpu_start(options, &w->peer, reason)
                             : fail(reason, STATUS_MEMORY, "webgpu: no memory for the engine");
    if (status)
        close(w);
    else
        *self = w;
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct webgpu *w = self;
    struct webgpu_job as;
    w->prepared = false;
    enum status status = webgpu_job_make(job, &as, reason);
    if (!status)
        status = webgpu_give(&w->peer, &as.program, reason);
    w->tri_count = job->scene->tri_count;
    w->bytes = as.bytes;
    webgpu_job_free(&as);
    w->prepared = !status;
    return status == STATUS_REFUSED ? STATUS_UNSUPPORTED : status;
}

/* Takes the answers of one request. */
static enum status take(struct webgpu *w, size_t first, size_t count, struct hit *hit,
                        struct trace_report *report, struct reason *reason)
{
    for (size_t i = 0; i < count; i++) {
        const struct webgpu_answer *answer = &w->answer[i];
        char what[160] = "";
        if (answer->flag == ABI_FLAG_DONE &&
            (answer->hit.prim < w->tri_count || answer->hit.prim == ABI_NO_PRIM)) {
            hit[i] = answer->hit;
            continue;
        }
        report->flags = answer->flag;
        if (answer->flag != ABI_FLAG_DONE)
            text_append(what, sizeof what, "ray %zu was not finished: %s", first + i,
                        dispatch_cause(answer->flag));
        else
            text_append(what, sizeof what, "its answer to ray %zu names triangle %u of %u",
                        first + i, answer->hit.prim, w->tri_count);
        return pipe_peer_blame(&w->peer.pipe, first + i, reason, what);
    }
    return STATUS_OK;
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    struct webgpu *w = self;
    enum status status = STATUS_OK;
    *report = (struct trace_report){.memory_bytes = w->bytes};
    if (!w->prepared)
        return fail(reason, STATUS_DEVICE, "webgpu: nothing is prepared to be traced");
    for (size_t first = 0; first < ray_count && !status; first += RAYS_MOST) {
        const size_t rest = ray_count - first, count = rest < RAYS_MOST ? rest : RAYS_MOST;
        const uint64_t start = time_ns();
        status = webgpu_run(&w->peer, first, count, ray + first, w->answer, reason);
        report->ns += time_ns() - start;
        if (!status)
            status = take(w, first, count, hit + first, report, reason);
    }
    report->core_ns = report->ns; /* this thread only waits */
    return status;
}

static enum engine_fault fault(void *self, size_t *ray)
{
    const struct webgpu *w = self;
    *ray = w->peer.pipe.fault_ray;
    return w->peer.pipe.fault;
}

static struct model model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)self;
    return model_of_tri(tri, ROUNDING_WGSL, false);
}

static void describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes)
{
    (void)engine;
    struct webgpu_card card;
    struct reason reason;
    text[0] = '\0';
    if (webgpu_card_make(options, &card, &reason))
        text_append(text, text_bytes, "%s\n", reason.text);
    else
        webgpu_card_text(&card, text, text_bytes);
}

extern const struct engine engine_webgpu;
const struct engine engine_webgpu = {
    .name = "webgpu",
    .gpu = true,
    .summary = "WGSL, run by Dawn in Node, in a process of its own",
    .needs_packed = true,
    .compiles = true,
    .foreign_bits = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .fault = fault,
    .model = model,
    .close = close,
    .describe = describe,
};
