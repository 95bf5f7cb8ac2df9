/* What the matrix measures besides speed: bytes, errors, cache lines. */
#include "cmd/bench/cmd_bench_matrix.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

#define SAMPLE   4096 /* prim rays, and as many rand rays, with exact answers */
#define LEAKS    4096 /* rays aimed at edges, and as many at vertices */
#define RUNS     4    /* runs of rays; the first fills the cache, the others are counted */
#define RUN_RAYS 512

/* Makes a sample: half rays of kind `a` and half of kind `b`, evenly spread. */
static enum status make_sample(struct matrix *m, enum matrix_kind a, enum matrix_kind b,
                               struct known_rays *out, struct reason *reason)
{
    size_t each = m->count < SAMPLE ? m->count : SAMPLE;
    enum status status = known_alloc(2 * each, out, reason);
    for (size_t i = 0; i < each && !status; i++) {
        size_t from = i * m->count / each;
        out->ray[i] = m->ray[a][from];
        out->ray[each + i] = m->ray[b][from];
    }
    if (!status)
        status = known_decide(m->oracle, m->scene, 0, 0, out, reason);
    return status;
}

static enum status make_leaks(struct matrix *m, struct reason *reason)
{
    size_t each = m->count < LEAKS ? m->count : LEAKS;
    enum status status = known_alloc(2 * each, &m->leak, reason);
    for (int target = 0; target < 2 && !status; target++)
        status = leak_rays_make(m->oracle, m->scene, (enum leak_target)target, m->bench->seed, each,
                                m->leak.ray + (target ? each : 0), reason);
    if (status)
        known_free(&m->leak);
    else
        status = known_decide(m->oracle, m->scene, 0, 0, &m->leak, reason);
    return status == STATUS_INPUT ? STATUS_OK : status; /* an open mesh has no leak rays */
}

enum status matrix_known_make(struct matrix *matrix, struct reason *reason)
{
    enum status status = make_sample(matrix, KIND_PRIM, KIND_RAND, &matrix->sample, reason);
    if (!status)
        status = make_sample(matrix, KIND_O_SHAD, KIND_O_RAND, &matrix->any, reason);
    return status ? status : make_leaks(matrix, reason);
}

/* --- errors ----------------------------------------------------------------------------------- */

static enum status count_errors(struct matrix *m, const struct contestant *c,
                                struct matrix_row *row, struct reason *reason)
{
    struct trace_report report;
    struct error_sum sum = {.rays = 0};
    enum status status = known_trace(&m->sample, c, m->hit, &report, reason);
    row->held_bytes = report.memory_bytes;
    row->told = !c->layout && !c->engine->library && !c->engine->gpu;
    if (row->told) {
        row->node_bytes = report.node_bytes;
        row->scene_bytes = report.scene_bytes;
    }
    if (!status)
        status = error_sum_make(m->oracle, m->scene, m->sample.ray, m->sample.truth, m->hit,
                                m->sample.count, &sum, reason);
    row->asked = sum.rays;
    row->lost = sum.kind[ERROR_LOST];
    row->wrong = sum.kind[ERROR_PHANTOM] + sum.kind[ERROR_WRONG];
    row->judged = known_is_judged(c);
    if (!status)
        status =
            known_judge(m->oracle, &m->sample, c, QUERY_CLOSEST, m->hit, &row->verdicts, reason);
    row->leak_rays = m->leak.count;
    if (!status && m->leak.count)
        status = known_trace(&m->leak, c, m->hit, &report, reason);
    for (size_t i = 0; i < m->leak.count && !status; i++)
        row->leaks += m->hit[i].prim == ABI_NO_PRIM;
    if (!status && m->leak.count)
        status = known_judge(m->oracle, &m->leak, c, QUERY_CLOSEST, m->hit, &row->verdicts, reason);
    return status;
}

enum status matrix_judge_any(struct matrix *matrix, const struct contestant *c,
                             struct matrix_row *row, struct reason *reason)
{
    struct trace_report report;
    if (row->judged_any)
        return STATUS_OK;
    enum status status = known_trace(&matrix->any, c, matrix->hit, &report, reason);
    if (!status)
        status = known_judge(matrix->oracle, &matrix->any, c, QUERY_ANY, matrix->hit,
                             &row->verdicts, reason);
    row->judged_any = true;
    return status;
}

enum status matrix_judge_timed(struct matrix *matrix, enum matrix_kind kind,
                               const struct contestant *c, struct matrix_row *row,
                               struct reason *reason)
{
    const bool any = kind >= MATRIX_CLOSEST;
    const struct known_rays *all = any ? &matrix->any : &matrix->sample;
    const size_t each = all->count / 2;
    const size_t half = kind == KIND_RAND || kind == KIND_O_RAND ? each : 0;
    struct known_rays part = {all->ray + half, all->truth + half, each};
    if (kind == KIND_DIFF || c->few)
        return STATUS_OK;
    for (size_t i = 0; i < each; i++)
        matrix->hit[i] = c->answer[i * matrix->count / each];
    struct known_verdicts one = {0};
    enum status status = known_judge(matrix->oracle, &part, c, any ? QUERY_ANY : QUERY_CLOSEST,
                                     matrix->hit, &one, reason);
    known_add(&row->verdicts, &one);
    known_add(&row->timed, &one);
    return status;
}

void matrix_forget_timed(struct matrix_row *row)
{
    row->verdicts.compared -= row->timed.compared;
    row->verdicts.allowed -= row->timed.allowed;
    row->verdicts.wrong -= row->timed.wrong;
    row->timed = (struct known_verdicts){0};
}

/* --- lines ------------------------------------------------------------------------------------ */

/* A traversal whose reads are recorded: of engine fast or fast_small, kd, or of a packed tree, or
 * of the dual-split tree that is made of that. */
struct watched {
    struct touch *touch;
    const struct fast_tree *fast;
    const struct kd_tree *kd;
    const struct dual_tree *dual;
    struct job job;
    struct cache_sim cache;
};

static enum status watch_kind(const struct matrix *m, struct watched *w, int kind,
                              struct matrix_touch *out)
{
    size_t runs = m->count / RUN_RAYS < RUNS ? m->count / RUN_RAYS : RUNS;
    size_t length = runs ? RUN_RAYS : m->count, counted = 0;
    enum status status = STATUS_OK;
    runs = runs ? runs : 1;
    for (size_t run = 0; run < runs; run++) {
        const struct ray *ray = m->ray[kind] + run * (m->count / runs);
        if (run <= 1) {
            cache_sim_restart(&w->cache);
            counted = 0;
        }
        for (size_t i = 0; i < length && !status; i++, counted++) {
            struct hit hit;
            if (w->fast)
                touch_fast(w->fast, &ray[i], false, &w->cache, &hit);
            else if (w->kd)
                touch_kd(w->kd, &ray[i], &w->cache, &hit);
            else if (w->dual)
                touch_dual(w->touch, w->dual, &w->job, &ray[i], &hit);
            else
                status = touch_ray(w->touch, &w->job, &ray[i], &hit);
        }
    }
    double per_ray = (double)CACHE_SIM_LINE / (double)(counted ? counted : 1);
    out->looked = per_ray * (double)w->cache.counts.lines;
    for (int level = 0; level < CACHE_SIM_LEVELS; level++)
        out->beyond[level] = per_ray * (double)w->cache.counts.beyond[level];
    return status;
}

static enum status watch(struct matrix *m, struct watched *w, struct matrix_row *row,
                         struct reason *reason)
{
    enum status status = cache_sim_make(cache_sim_usual, &w->cache, reason);
    for (int kind = 0; kind < MATRIX_CLOSEST && !status; kind++) {
        status = watch_kind(m, w, kind, &row->touch[kind]);
        if (status)
            return fail(reason, status, "%s: a ray was not finished", row->entry->name);
    }
    row->touched = status == STATUS_OK;
    cache_sim_free(&w->cache);
    return status;
}

static enum status watch_fast(struct matrix *m, const struct contestant *c, struct matrix_row *row,
                              struct reason *reason)
{
    struct fast_tree *tree = aligned_alloc(_Alignof(struct fast_tree), sizeof *tree);
    if (!tree)
        return fail(reason, STATUS_MEMORY, "no memory for a tree");
    const struct fast_form *form = fast_form_of(c->engine == engine_find("fast_small"), &c->packed);
    enum status status = form->make(c->bvh, m->scene, tree, reason);
    if (!status) {
        struct watched w = {.fast = tree};
        row->node_bytes = fast_node_bytes(tree) * (uint64_t)tree->node_count;
        row->item_bytes = 4 * tree->block_words;
        status = watch(m, &w, row, reason);
        fast_free(tree);
    }
    free(tree);
    return status;
}

static enum status watch_kd(struct matrix *m, struct matrix_row *row, struct reason *reason)
{
    struct kd_tree tree;
    enum status status = kd_make(m->scene, &tree, reason);
    struct watched w = {.kd = &tree};
    row->node_bytes = kd_node_bytes(&tree);
    row->item_bytes = kd_item_bytes(&tree);
    if (!status)
        status = watch(m, &w, row, reason);
    kd_free(&tree);
    return status;
}

/* `dual`: the tree that is traced; NULL: the packed one itself. */
static enum status watch_packed(struct matrix *m, const struct contestant *c,
                                const struct dual_tree *dual, struct matrix_row *row,
                                struct reason *reason)
{
    struct touch *touch = alloc_zeroed(1, sizeof *touch);
    struct watched w = {.touch = touch, .dual = dual, .job = {.box = c->box, .tri = c->tri}};
    bool gpu = matrix_entry_is_gpu(row->entry);
    if (!touch)
        return fail(reason, STATUS_MEMORY, "no memory to watch a tree");
    enum status status = touch_make(&c->packed, m->scene, gpu, &w.cache, touch, reason);
    if (!status)
        status = watch(m, &w, row, reason);
    touch_free(touch);
    free(touch);
    return status;
}

static enum status watch_dual(struct matrix *m, const struct contestant *c, struct matrix_row *row,
                              struct reason *reason)
{
    struct dual_tree tree;
    enum status status = dual_make(&c->packed, DUAL_BY_COST, &tree, reason);
    row->node_bytes = dual_node_bytes(&tree);
    if (!status)
        status = watch_packed(m, c, &tree, row, reason);
    dual_free(&tree);
    return status;
}

/* --- all -------------------------------------------------------------------------------------- */

/* Embree's traversal reads what Embree holds without the buffers of vertices and indices. Its
 * leaves have copies of the vertices, except in compact mode, where they have only indices. */
static void measure_embree(const struct matrix *m, struct matrix_row *row)
{
    uint64_t arrays = 12 * ((uint64_t)m->scene->vertex_count + m->scene->tri_count);
    row->scene_bytes = row->entry->compact ? arrays : 0;
    row->node_bytes = row->held_bytes > arrays ? row->held_bytes - arrays : 0;
}

enum status matrix_measure(struct matrix *matrix, const struct contestant *c,
                           struct matrix_row *row, struct reason *reason)
{
    enum status status = count_errors(matrix, c, row, reason);
    if (status)
        return status;
    if (!c->layout && c->engine == engine_find("kd"))
        return watch_kd(matrix, row, reason);
    if (!c->layout) {
        if (!row->told)
            measure_embree(matrix, row);
        return STATUS_OK;
    }
    if (matrix_collapses(c->engine))
        return watch_fast(matrix, c, row, reason);
    row->node_bytes = packed_node_bytes(&c->packed);
    row->item_bytes = packed_item_bytes(&c->packed);
    if (tri_store_reads_scene(c->packed.store))
        row->scene_bytes =
            matrix_entry_is_gpu(row->entry)
                ? 36 * (uint64_t)matrix->scene->tri_count
                : 12 * ((uint64_t)matrix->scene->vertex_count + matrix->scene->tri_count);
    if (c->engine->own_tree)
        return watch_dual(matrix, c, row, reason);
    return watch_packed(matrix, c, NULL, row, reason);
}
