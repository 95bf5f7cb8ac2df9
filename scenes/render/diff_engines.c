#include "scenes/render/diff_engines.h"

#include "scenes/picture/image_diff.h"

#include <math.h>
#include <stdlib.h>

/* Memory for the walks of a batch, both sides together. */
#define BATCH_BYTES ((size_t)64 << 20)
#define BATCH_MOST  16384

enum status side_open(const struct engine *engine, const struct engine_options *options,
                      const struct frame_job *job, bool waves, struct side *out,
                      struct reason *reason)
{
    *out = (struct side){.engine = engine, .options = *options, .job = *job};
    enum status status = renderer_open(engine, options, waves, &out->renderer, reason);
    if (!status)
        status = renderer_prepare(out->renderer, job, reason);
    if (!status) {
        out->model = renderer_model(out->renderer, job->job.tri);
        if (engine->needs_packed && !job_keeps_watertight(&job->job))
            out->model.watertight = false; /* the triangle test is, the boxes are not */
    } else {
        side_close(out);
    }
    return status;
}

void side_close(struct side *side)
{
    if (side->by_waves != side->renderer)
        renderer_close(side->by_waves);
    renderer_close(side->renderer);
    frame_free(&side->frame);
    *side = (struct side){0};
}

enum status side_draw(struct side *side, const struct view *view, struct reason *reason)
{
    size_t count = (size_t)side->job.width * side->job.height;
    struct frame *frame = &side->frame;
    size_t bytes = count * (sizeof *frame->pixel + 4 * sizeof(float) +
                            side->job.look.bounces * sizeof *frame->segment);
    if (bytes > SIDE_BYTES_MOST)
        return fail(reason, STATUS_LIMIT,
                    "%u x %u pixels with %u bounces: their paths take %zu MB for each engine, at "
                    "most %zu",
                    side->job.width, side->job.height, side->job.look.bounces, bytes >> 20,
                    SIDE_BYTES_MOST >> 20);
    if (!frame->pixel && !frame_make(count, side->job.look.bounces, frame))
        return fail(reason, STATUS_MEMORY, "no memory for a picture of %u x %u", side->job.width,
                    side->job.height);
    for (size_t i = 0; i < count; i++)
        frame->bound[i] = NAN; /* stays NaN if the engine has its own renderer */
    return renderer_frame(side->renderer, view, frame, &side->report, reason);
}

static enum status ask(void *user, enum query query, const struct ray *ray, size_t count,
                       struct hit *hit, struct reason *reason)
{
    return renderer_ask(user, query, ray, count, hit, reason);
}

enum status side_walk(struct side *side, const struct view *view, const size_t *pixel, size_t count,
                      struct diff_walk *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    *out = (struct diff_walk){0};
    if (!side->by_waves && renderer_by_waves(side->renderer)) {
        side->by_waves = side->renderer;
    } else if (!side->by_waves) {
        status = renderer_open(side->engine, &side->options, true, &side->by_waves, reason);
        if (!status)
            status = renderer_prepare(side->by_waves, &side->job, reason);
    }
    if (!status)
        status = walk_make(&side->job, view, pixel, count, ask, side->by_waves, out, reason);
    return status;
}

enum status side_walk_pixel(struct side *side, const struct view *view, size_t pixel,
                            struct diff_walk *walk, struct side_drawn *drawn, struct reason *reason)
{
    *drawn = (struct side_drawn){.follows = true};
    enum status status = side_walk(side, view, &pixel, 1, walk, reason);
    if (status || renderer_by_waves(side->renderer))
        return status;
    status = side_draw(side, view, reason);
    if (status)
        return status;
    uint32_t bounces = side->job.look.bounces;
    const struct segment *segment = side->frame.segment + pixel * bounces;
    struct segment walked[FRAME_BOUNCES_MOST];
    walk_segments(walk, 0, walked);
    drawn->field = path_first(walked, segment, bounces, &drawn->segment);
    drawn->follows = why_walk_is_frame(walk, 0, segment, side->frame.pixel[pixel], false);
    return STATUS_OK;
}

bool sides_same_bits(const struct side *a, const struct side *b)
{
    const struct job *of_a = &a->job.job, *of_b = &b->job.job;
    return a->model.bits && b->model.bits && of_a->packed == of_b->packed &&
           of_a->box == of_b->box && of_a->tri == of_b->tri;
}

enum status pair_compare(const struct side *a, const struct side *b, struct pair *out,
                         size_t **pixel, size_t *count, struct reason *reason)
{
    size_t all = (size_t)a->job.width * a->job.height, capacity = 0;
    void *list = NULL;
    *out =
        (struct pair){.same_bits = sides_same_bits(a, b),
                      .bounded = renderer_by_waves(a->renderer) || renderer_by_waves(b->renderer)};
    *count = 0;
    for (size_t i = 0; i < all; i++) {
        const struct frame_diff before = out->diff;
        frame_compare_pixel(&a->frame, &b->frame, i, a->job.look.bounces, &out->diff);
        if (out->diff.allowed > before.allowed && out->border_count < PAIR_KEPT) {
            float bound = a->frame.bound[i];
            out->border[out->border_count++] =
                (struct pixel_border){i,
                                      {a->frame.pixel[i], b->frame.pixel[i]},
                                      isnan(bound) ? b->frame.bound[i] : bound};
        }
        if (out->diff.paths_apart == before.paths_apart && out->diff.excess == before.excess)
            continue;
        if (array_reserve(&list, &capacity, *count + 1, sizeof **pixel)) {
            free(list);
            *pixel = NULL;
            return fail(reason, STATUS_MEMORY, "no memory for %zu pixels", all);
        }
        ((size_t *)list)[(*count)++] = i;
    }
    *pixel = list;
    out->asked = *count;
    return STATUS_OK;
}

size_t pair_batch(const struct frame_job *job)
{
    size_t most = BATCH_BYTES / (2 * walk_bytes(job));
    return most < 1 ? 1 : most > BATCH_MOST ? BATCH_MOST : most;
}

static void count_pixel(struct pair *pair, const struct pixel_why *found)
{
    const struct path_why *why = &found->why;
    if (pair->why[why->why] < PAIR_KEPT)
        pair->example[why->why][pair->why[why->why]] = *found;
    pair->why[why->why]++;
    pair->verdict[why->verdict] += why->why == WHY_ALLOWED;
    pair->over = why->over > pair->over ? why->over : pair->over;
}

/* Explains one pixel: why the two paths part, and whether each picture follows from its walk. */
static enum status explain_pixel(const struct side *const side[2], const struct diff_walk walk[2],
                                 const struct why_judges *judges, size_t index,
                                 struct pixel_why *out, struct reason *reason)
{
    uint32_t bounces = side[0]->job.look.bounces;
    const struct frame *a = &side[0]->frame, *b = &side[1]->frame;
    out->apart = image_diff_of(a->pixel[out->pixel], b->pixel[out->pixel]);
    out->field = path_first(a->segment + out->pixel * bounces, b->segment + out->pixel * bounces,
                            bounces, &out->segment);
    enum status status = why_paths(judges, &walk[0], &walk[1], index, &out->why, reason);
    for (unsigned i = 0; i < 2 && !status && !why_is_fault(out->why.why); i++) {
        const struct frame *frame = &side[i]->frame;
        if (why_walk_is_frame(&walk[i], index, frame->segment + out->pixel * bounces,
                              frame->pixel[out->pixel], renderer_by_waves(side[i]->renderer)))
            continue;
        out->why.why = WHY_RENDERER;
        out->why.side = i;
    }
    return status;
}

static enum status explain_walks(const struct side *const side[2], const struct diff_walk walk[2],
                                 const struct why_judges *judges, const size_t *pixel, size_t count,
                                 struct pair *pair, struct reason *reason)
{
    struct pixel_why *found = alloc_zeroed(count, sizeof *found);
    if (!found)
        return fail(reason, STATUS_MEMORY, "no memory to explain %zu pixels", count);
    int failed = 0;
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : failed)
    for (long long i = 0; i < (long long)count; i++) {
        struct reason unsaid;
        found[i].pixel = pixel[i];
        failed += explain_pixel(side, walk, judges, (size_t)i, &found[i], &unsaid) != STATUS_OK;
    }
    for (size_t i = 0; i < count && !failed; i++)
        count_pixel(pair, &found[i]);
    free(found);
    return failed ? fail(reason, STATUS_MEMORY, "no memory to explain %zu pixels", count)
                  : STATUS_OK;
}

enum status pair_explain(struct side *a, struct side *b, const struct view *view,
                         const struct oracle *oracle, const size_t *pixel, size_t count,
                         struct pair *pair, struct reason *reason)
{
    struct diff_walk walk[2] = {{0}, {0}};
    struct why_judges judges = {0};
    const struct side *const side[2] = {a, b};
    const struct model model[2] = {a->model, b->model};
    enum query query = a->job.look.profile == PROFILE_RTRS ? QUERY_CLOSEST : QUERY_ANY;
    enum status status = why_judges_make(oracle, model, query, &judges, reason);
    judges.published[0] = a->published;
    judges.published[1] = b->published;
    if (!status)
        status = side_walk(a, view, pixel, count, &walk[0], reason);
    if (!status)
        status = side_walk(b, view, pixel, count, &walk[1], reason);
    if (!status)
        status = explain_walks(side, walk, &judges, pixel, count, pair, reason);
    walk_free(&walk[0]);
    walk_free(&walk[1]);
    why_judges_free(&judges);
    return status;
}

bool pair_agrees(const struct pair *pair)
{
    size_t faults = 0, seen = 0;
    for (enum why why = WHY_SAME; why < WHY_COUNT; why++) {
        seen += pair->why[why];
        faults += why_is_fault(why) ? pair->why[why] : 0;
    }
    size_t excess = pair->bounded ? pair->diff.excess : 0;
    if (pair->same_bits && pair->diff.paths_apart + excess > 0)
        return false;
    return faults == 0 && seen == pair->asked;
}
