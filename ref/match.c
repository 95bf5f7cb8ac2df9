#include "ref/match.h"

#include "ref/trace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Below one hit in this many rays (and always without a hit) a row proves nothing. */
#define VACUOUS_ONE_IN 1000

const char *row_status_name(enum row_status status)
{
    static const char *const names[] = {"ok", "refused", "skipped", "failed", "vacuous"};
    return (size_t)status < ARRAY_COUNT(names) ? names[status] : "unknown";
}

bool row_failed(const struct row *row)
{
    return row->status == ROW_VACUOUS || (row->status == ROW_OK && row->differences > 0);
}

static struct job job_of(const struct match *match, const struct engine *engine)
{
    return (struct job){.scene = match->scene,
                        .packed = engine->needs_packed ? &match->packed : NULL,
                        .box = match->options.box,
                        .tri = match->options.tri,
                        .query = match->options.query};
}

/* Closest hits of rays `from` on, by engine cpu over its own f32 tree: the reference where brute
 * force would take too long. */
static enum status reference_by_tree(struct match *match, size_t from, struct reason *reason)
{
    const struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    const struct box_test *robust = box_test_find("robust");
    struct bvh bvh = {0};
    struct packed packed = {0};
    enum status status = builder_find("median")->build(match->scene, &build, &bvh, reason);
    if (status == STATUS_OK)
        status = packed_make(layout_find("f32"), &bvh, match->scene, &packed, reason);
    int unfinished = 0;
    if (status == STATUS_OK) {
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : unfinished)
        for (long long i = (long long)from; i < (long long)match->ray_count; i++)
            if (trace_ray(&packed, match->scene, robust, match->options.tri, QUERY_CLOSEST,
                          &match->ray[i], &match->reference[i], NULL))
                unfinished++;
    }
    if (unfinished)
        status = fail(reason, STATUS_DEVICE, "reference: %d rays not finished", unfinished);
    packed_free(&packed);
    bvh_free(&bvh);
    return status;
}

static enum status reference_make(struct match *match, struct reason *reason)
{
    uint64_t per_ray = match->scene->tri_count ? match->scene->tri_count : 1;
    uint64_t affordable = match->options.brute_budget / per_ray;
    if (match->options.brute_rays && affordable > match->options.brute_rays)
        affordable = match->options.brute_rays;
    match->brute_count = affordable < match->ray_count ? (size_t)affordable : match->ray_count;
#pragma omp parallel for schedule(dynamic, 64)
    for (long long i = 0; i < (long long)match->brute_count; i++)
        trace_brute(match->scene, match->options.tri, QUERY_CLOSEST, &match->ray[i],
                    &match->reference[i]);
    if (match->brute_count == match->ray_count)
        return STATUS_OK;
    return reference_by_tree(match, match->brute_count, reason);
}

enum status match_make(const struct scene *scene, const struct ray *ray, size_t ray_count,
                       const struct match_options *options, struct pool *pool, struct match *out,
                       struct reason *reason)
{
    *out = (struct match){
        .options = *options, .scene = scene, .ray = ray, .ray_count = ray_count, .pool = pool};
    enum status status = options->builder->build(scene, &options->build, &out->bvh, reason);
    if (status == STATUS_OK) {
        out->reference = alloc_zeroed(ray_count, sizeof *out->reference);
        out->answer = alloc_zeroed(ray_count, sizeof *out->answer);
        out->stats = bvh_stats(&out->bvh, scene);
        if (!out->reference || !out->answer)
            status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", ray_count);
    }
    if (status == STATUS_OK)
        status = reference_make(out, reason);
    if (status)
        match_free(out);
    return status;
}

static void match_unpack(struct match *match)
{
    packed_free(&match->packed);
    free(match->cpu);
    match->cpu = NULL;
}

enum status match_pack(struct match *match, const struct layout *layout, struct reason *reason)
{
    match_unpack(match);
    return packed_make(layout, &match->bvh, match->scene, &match->packed, reason);
}

enum status match_pack_auto(struct match *match, char *refused, size_t refused_bytes,
                            struct reason *reason)
{
    match_unpack(match);
    return packed_make_auto(&match->bvh, match->scene, &match->packed, refused, refused_bytes,
                            reason);
}

void match_free(struct match *match)
{
    match_unpack(match);
    bvh_free(&match->bvh);
    free(match->reference);
    free(match->answer);
    *match = (struct match){0};
}

void match_set(struct match *match, const struct box_test *box, enum query query)
{
    match->options.box = box;
    match->options.query = query;
    free(match->cpu);
    match->cpu = NULL;
}

void match_refused(const struct match *match, const struct layout *layout,
                   const struct engine *engine, enum status cause, const struct reason *reason,
                   struct row *row)
{
    *row = (struct row){.options = match->options,
                        .stats = match->stats,
                        .engine = engine,
                        .layout = layout,
                        .status = ROW_REFUSED,
                        .cause = cause,
                        .reason = *reason};
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static enum subject subject_of(const struct engine *engine)
{
    if (strcmp(engine->name, "embree") == 0)
        return SUBJECT_EMBREE;
    if (strcmp(engine->name, "embree_robust") == 0)
        return SUBJECT_EMBREE_ROBUST;
    return SUBJECT_TREE;
}

/* Brute force answers as many rays as it was given work for, and once: its time per ray is known
 * from the number of triangles, and 100,000 rays on 70,000 triangles take minutes. */
static bool is_brute(const struct engine *engine)
{
    return !engine->needs_packed && subject_of(engine) == SUBJECT_TREE;
}

/* Traces `repeats` times; times and work go to the row, the hits of the last to match->answer. */
static enum status timed_traces(struct match *match, const struct engine *engine, void *self,
                                struct row *row)
{
    double speed[REPEAT_MOST];
    unsigned repeats = is_brute(engine) ? 1 : match->options.repeats;
    for (unsigned i = 0; i < repeats; i++) {
        struct trace_report report = {0};
        enum status status =
            engine->trace(self, match->ray, row->rays, match->answer, &report, &row->reason);
        if (status)
            return status;
        speed[i] = 1e3 * (double)row->rays / (double)(report.ns ? report.ns : 1);
        row->boxes = report.boxes;
        row->tris = report.tris;
        row->device_clock = report.device_clock;
        if (report.memory_bytes > row->memory_bytes)
            row->memory_bytes = report.memory_bytes;
    }
    qsort(speed, repeats, sizeof speed[0], by_size);
    row->mrays[0] =
        repeats % 2 ? speed[repeats / 2] : 0.5 * (speed[repeats / 2 - 1] + speed[repeats / 2]);
    row->mrays[1] = speed[0];
    row->mrays[2] = speed[repeats - 1];
    return STATUS_OK;
}

static void keep_finding(struct row *row, const struct match *match, size_t i,
                         const struct hit *expected, bool bits)
{
    if (row->finding_count < FINDING_MOST)
        row->finding[row->finding_count++] = (struct finding){.ray_index = i,
                                                              .ray = match->ray[i],
                                                              .expected = *expected,
                                                              .got = match->answer[i],
                                                              .bits = bits};
}

/* Compares with the reference. Brute force first: there the reference is complete. */
static void judge_row(struct match *match, struct row *row)
{
    unsigned char *verdict = alloc_zeroed(row->rays, 1);
    if (!verdict) {
        row->status = ROW_FAILED;
        row->cause = fail(&row->reason, STATUS_MEMORY, "no memory to judge %zu rays", row->rays);
        return;
    }
    struct judge complete = judge_make(match->scene, match->options.tri, match->options.query,
                                       subject_of(row->engine), true);
    struct judge partial = complete;
    partial.reference_complete = false;
#pragma omp parallel for schedule(dynamic, 64)
    for (long long i = 0; i < (long long)row->rays; i++)
        verdict[i] =
            (unsigned char)judge_answer((size_t)i < match->brute_count ? &complete : &partial,
                                        &match->ray[i], &match->reference[i], &match->answer[i]);
    for (size_t i = 0; i < row->rays; i++) {
        row->count[verdict[i]]++;
        row->hits += match->answer[i].prim != ABI_NO_PRIM;
        if (verdict[i] == VERDICT_DIFFERENT && row->judged)
            keep_finding(row, match, i, &match->reference[i], false);
    }
    row->compared = row->rays;
    row->brute = match->brute_count < row->rays ? match->brute_count : row->rays;
    if (row->judged)
        row->differences += row->count[VERDICT_DIFFERENT];
    free(verdict);
}

/* Fills match->cpu, which exact engines are compared with. */
static enum status cpu_hits(struct match *match, struct reason *reason)
{
    if (match->cpu)
        return STATUS_OK;
    const struct engine *cpu = engine_find("cpu");
    enum status status = STATUS_OK;
    void *self = pool_get(match->pool, cpu, &status, reason);
    struct job job = job_of(match, cpu);
    struct trace_report report;
    struct hit *hits = alloc_zeroed(match->ray_count, sizeof *hits);
    if (!hits)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", match->ray_count);
    if (status == STATUS_OK)
        status = cpu->prepare(self, &job, reason);
    if (status == STATUS_OK)
        status = cpu->trace(self, match->ray, match->ray_count, hits, &report, reason);
    if (status)
        free(hits);
    else
        match->cpu = hits;
    return status;
}

static enum status judge_bits_row(struct match *match, struct row *row)
{
    enum status status = cpu_hits(match, &row->reason);
    if (status)
        return status;
    for (size_t i = 0; i < row->rays; i++) {
        if (judge_bits(&match->ray[i], &match->cpu[i], &match->answer[i]) != VERDICT_DIFFERENT)
            continue;
        row->bit_differences++;
        keep_finding(row, match, i, &match->cpu[i], true);
    }
    row->differences += row->bit_differences;
    return STATUS_OK;
}

/* A row is judged against the reference only if nobody in it is as published: of the seed's parts
 * it is known that they differ, so their differences are counted. */
static bool is_judged(const struct match *match, const struct engine *engine)
{
    if (!engine->needs_packed)
        return true;
    return !match->packed.layout->faithful && !match->options.builder->faithful &&
           !match->options.box->faithful;
}

static enum status run_and_judge(struct match *match, const struct engine *engine, struct row *row)
{
    enum status status = STATUS_OK;
    void *self = pool_get(match->pool, engine, &status, &row->reason);
    if (status) {
        row->status = status == STATUS_UNSUPPORTED ? ROW_SKIPPED : ROW_FAILED;
        return status;
    }
    if (engine->needs_packed && !match->packed.layout) {
        row->status = ROW_FAILED;
        return fail(&row->reason, STATUS_INPUT, "engine %s needs a packed layout", engine->name);
    }
    struct job job = job_of(match, engine);
    status = engine->prepare(self, &job, &row->reason);
    if (status == STATUS_LIMIT || status == STATUS_UNSUPPORTED) {
        row->status = status == STATUS_LIMIT ? ROW_REFUSED : ROW_SKIPPED;
        return status;
    }
    row->status = ROW_FAILED; /* until it has finished */
    if (status == STATUS_OK)
        status = timed_traces(match, engine, self, row);
    if (status)
        return status;
    row->status = ROW_OK;
    row->judged = is_judged(match, engine);
    row->bits = engine->model(self, match->options.tri).bits;
    if (row->bits)
        status = judge_bits_row(match, row);
    if (status) {
        row->status = ROW_FAILED;
        return status;
    }
    judge_row(match, row);
    return row->cause;
}

void match_run(struct match *match, const struct engine *engine, struct row *row)
{
    *row = (struct row){.options = match->options,
                        .stats = match->stats,
                        .engine = engine,
                        .rays = match->ray_count};
    if (engine->needs_packed) {
        row->layout = match->packed.layout;
        row->node_bytes = packed_node_bytes(&match->packed);
        row->item_bytes = packed_item_bytes(&match->packed);
    }
    if (is_brute(engine) && match->brute_count > 0)
        row->rays = match->brute_count;
    row->cause = run_and_judge(match, engine, row);
    size_t floor = row->rays / VACUOUS_ONE_IN;
    if (row->status == ROW_OK && row->judged && row->hits < (floor ? floor : 1)) {
        row->status = ROW_VACUOUS;
        fail(&row->reason, STATUS_OK, "vacuous: %zu hits of %zu rays prove nothing", row->hits,
             row->rays);
    }
}

void *pool_get(struct pool *pool, const struct engine *engine, enum status *status,
               struct reason *reason)
{
    size_t i = 0;
    while (i < pool->count && pool->entry[i].engine != engine)
        i++;
    if (i == POOL_MOST) {
        *status = fail(reason, STATUS_LIMIT, "more than %d engines", POOL_MOST);
        return NULL;
    }
    if (i == pool->count) {
        pool->count++;
        pool->entry[i].engine = engine;
        pool->entry[i].status =
            engine->open(&pool->options, &pool->entry[i].self, &pool->entry[i].reason);
    }
    *status = pool->entry[i].status;
    if (*status && reason)
        *reason = pool->entry[i].reason;
    return pool->entry[i].self;
}

void pool_free(struct pool *pool)
{
    for (size_t i = 0; i < pool->count; i++)
        if (pool->entry[i].status == STATUS_OK)
            pool->entry[i].engine->close(pool->entry[i].self);
    pool->count = 0;
}
