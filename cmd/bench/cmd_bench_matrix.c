/* raydiff bench matrix: builders, layouts, triangle storages and engines on all kinds of rays.
 * Measures speed relative to Embree's, bytes, cache lines read, and errors. */
#include "cmd/bench/cmd_bench_matrix.h"
#include "cmd/common/cmd_screen.h"

#include "bench/measure/shadow_rays.h"
#include "ref/base/command.h"
#include "scenes/rays/rays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OWN_RAYS     65536
#define OWN_RAYS_GPU 8192
#define FEW          8 /* engine cpu traces every eighth ray */
#define GPU_GROUP    8 /* GPU contestants at a time: each opens a device */

const char *const matrix_kinds[MATRIX_KINDS] = {"prim", "rand", "diff", "o-shad", "o-rand"};

/* --- trees and rays --------------------------------------------------------------------------- */

/* Leaf size of an entry's tree: 1 for layouts and engines that collapse the tree into wider
 * nodes. */
static uint32_t leaf_of(const struct matrix_entry *e)
{
    bool collapses = layout_is_wide(e->layout) || matrix_collapses(e->engine);
    return collapses ? 1 : BUILD_LEAF_DEFAULT;
}

/* Returns the tree of an entry, which the first call builds. */
static enum status tree_of(struct matrix *m, const struct matrix_entry *e, const struct bvh **out,
                           struct reason *reason)
{
    uint32_t leaf = leaf_of(e);
    for (size_t i = 0; i < m->tree_count; i++) {
        const struct matrix_tree *t = &m->tree[i];
        *out = &t->bvh;
        if (t->builder == e->builder && t->passes == e->passes && t->leaf == leaf)
            return STATUS_OK;
    }
    if (m->tree_count == MATRIX_TREES)
        return fail(reason, STATUS_LIMIT, "more than %d trees", MATRIX_TREES);
    struct matrix_tree *t = &m->tree[m->tree_count];
    const struct build_options build = {
        .leaf = leaf, .eps = BUILD_EPS_DEFAULT, .passes = e->passes};
    *t = (struct matrix_tree){.builder = e->builder, .passes = e->passes, .leaf = leaf};
    progress_step(&m->bench->progress, "%s: building by %s", m->spec, e->builder->name);
    enum status status = bvh_build(e->builder, m->scene, &build, &t->bvh, reason);
    m->tree_count += status == STATUS_OK;
    *out = &t->bvh;
    return status;
}

/* Makes shadow rays from the hits of engine fast, which needs a tree. */
static enum status make_shadow_rays(struct matrix *m, struct reason *reason)
{
    const struct contestant fast = {.engine = engine_find("fast"),
                                    .layout = layout_find("f32"),
                                    .box = box_test_find("watertight"),
                                    .tri = tri_test_find("woop")};
    const struct matrix_entry entry = {
        .engine = fast.engine, .layout = fast.layout, .builder = builder_find("sah_binned")};
    struct trace_report report;
    enum status status = tree_of(m, &entry, &m->race.bvh, reason);
    if (!status)
        status = race_add(&m->race, &fast, &m->bench->engines, reason);
    if (!status)
        status = fast.engine->trace(m->race.contestant[0].self, m->ray[KIND_PRIM], m->count, m->hit,
                                    &report, reason);
    if (!status)
        status = shadow_rays_make(m->scene, m->ray[KIND_PRIM], m->hit, m->count,
                                  m->ray[KIND_O_SHAD], reason);
    race_leave(&m->race);
    return status;
}

static enum status make_rays(struct matrix *m, struct reason *reason)
{
    static const char *const sets[MATRIX_KINDS] = {"primary", "random", "bounce", NULL, "random"};
    enum status status = STATUS_OK;
    size_t room = m->count > 8192 ? m->count : 8192; /* the leak rays' answers must fit, too */
    m->hit = alloc_zeroed(room, sizeof *m->hit);
    m->few = alloc_zeroed(m->count / FEW + 1, sizeof *m->few);
    for (int kind = 0; kind < MATRIX_KINDS; kind++) {
        m->ray[kind] = alloc_zeroed(m->count, sizeof *m->ray[kind]);
        if (!m->ray[kind] || !m->hit || !m->few)
            return fail(reason, STATUS_MEMORY, "no memory for %zu rays", m->count);
        progress_step(&m->bench->progress, "%s: %s rays", m->spec, matrix_kinds[kind]);
        /* Any-hit random rays differ from the closest-hit ones. */
        if (sets[kind])
            status = ray_set_make(ray_set_find(sets[kind]), m->scene,
                                  m->bench->seed + (kind == KIND_O_RAND), m->count, m->ray[kind],
                                  reason);
        else
            status = make_shadow_rays(m, reason);
        if (status)
            return status;
    }
    return status;
}

/* --- a group of contestants ------------------------------------------------------------------- */

/* Adds an entry to the race, or prints why it cannot run here. */
static enum status enter(struct matrix *m, const struct matrix_entry *e, unsigned threads,
                         bool *entered, struct reason *reason)
{
    struct engine_options options = m->bench->engines;
    struct contestant who = {.engine = e->engine,
                             .layout = e->layout,
                             .store = e->store,
                             .box = box_test_find("watertight"),
                             .tri = tri_test_find("woop"),
                             .few = e->engine->needs_packed && !e->engine->gpu &&
                                    !matrix_collapses(e->engine)};
    enum status status = STATUS_OK;
    options.threads = threads;
    options.compact = e->compact;
    options.avx512 = e->avx512;
    if (e->layout)
        status = tree_of(m, e, &who.bvh, reason);
    if (!status) {
        progress_step(&m->bench->progress, "%s: preparing %s", m->spec, e->name);
        status = race_add(&m->race, &who, &options, reason);
    }
    *entered = status == STATUS_OK;
    if (status == STATUS_LIMIT || status == STATUS_UNSUPPORTED) {
        progress_end(&m->bench->progress);
        screen_line(4, "  %s left out: %s\n", e->name, reason->text);
        bench_left_out(m->bench, e->layout, e->store, status);
        return STATUS_OK;
    }
    if (status == STATUS_REFUSED) { /* the others continue */
        bench_failed(m->bench, m->spec, status, reason);
        return STATUS_OK;
    }
    return status;
}

static void take_speeds(struct matrix *m, int kind, struct matrix_row **row)
{
    size_t rounds = (size_t)m->bench->rounds;
    for (size_t i = 0; i < m->race.count; i++) {
        struct contestant *c = &m->race.contestant[i];
        if (!row[i])
            continue;
        row[i]->mrays[kind] = spread_of(c->mrays, rounds);
        row[i]->ratio[kind] = spread_of(c->ratio, rounds);
        row[i]->warm[kind] =
            m->race.warm ? spread_of(c->warm_ratio, rounds) : (struct spread){NAN, NAN, NAN};
        row[i]->rays = c->few ? m->race.few_count : m->count;
        if (kind >= MATRIX_MEAN)
            continue;
        row[i]->mean *= pow(row[i]->ratio[kind].median, 1.0 / MATRIX_MEAN);
        row[i]->mean_warm *= pow(row[i]->warm[kind].median, 1.0 / MATRIX_MEAN);
    }
}

static enum status prepare_any(struct matrix *m, struct matrix_row **row, struct reason *reason)
{
    enum status status = race_prepare(&m->race, QUERY_ANY, reason);
    for (size_t i = 0; i < m->race.count && !status; i++)
        if (row[i])
            status = matrix_judge_any(m, &m->race.contestant[i], row[i], reason);
    return status;
}

static enum status race_kinds(struct matrix *m, struct matrix_row **row, struct reason *reason)
{
    enum status status = STATUS_OK;
    char label[160];
    m->race.few = m->few;
    m->race.few_count = (m->count + FEW - 1) / FEW;
    for (int kind = 0; kind < MATRIX_KINDS && !status; kind++) {
        snprintf(label, sizeof label, "%.80s, %s rays", m->spec, matrix_kinds[kind]);
        m->race.label = label;
        for (size_t i = 0; i < m->race.few_count; i++)
            m->few[i] = m->ray[kind][i * FEW];
        if (kind == MATRIX_CLOSEST)
            status = prepare_any(m, row, reason);
        if (!status)
            status = race_run(&m->race, kind < MATRIX_CLOSEST ? QUERY_CLOSEST : QUERY_ANY,
                              m->ray[kind], m->count, reason);
        for (size_t i = 0; i < m->race.count && !status; i++)
            if (row[i])
                status = matrix_judge_timed(m, (enum matrix_kind)kind, &m->race.contestant[i],
                                            row[i], reason);
        if (!status)
            take_speeds(m, kind, row);
    }
    return status;
}

/* Races entries first to last - 1. Also enters the entry that they are compared with, if it is not
 * among them. */
static enum status play_group(struct matrix *m, size_t first, size_t last, unsigned threads,
                              const struct matrix_row *known, struct reason *reason)
{
    struct matrix_row *row[CONTESTANTS] = {NULL};
    enum status status = STATUS_OK;
    bool entered;
    m->race.warm = !matrix_entry_is_gpu(&m->entries.entry[first]);
    m->race.core_time = threads == 1 && m->race.warm;
    if (first > 0)
        status = enter(m, &m->entries.entry[0], threads, &entered, reason);
    for (size_t i = first; i < last && !status; i++) {
        const struct matrix_entry *e = &m->entries.entry[i];
        status = enter(m, e, threads, &entered, reason);
        if (status || !entered)
            continue;
        const struct contestant *c = &m->race.contestant[m->race.count - 1];
        struct matrix_row *made = &m->row[m->row_count++];
        row[m->race.count - 1] = made;
        *made = (struct matrix_row){.entry = e};
        progress_step(&m->bench->progress, "%s: errors and lines of %s", m->spec, e->name);
        for (const struct matrix_row *k = known; k && k->entry; k++)
            if (k->entry == e)
                *made = *k, matrix_forget_timed(made);
        if (!made->asked)
            status = matrix_measure(m, c, made, reason);
        made->threads = threads;
        made->mean = made->mean_warm = 1;
    }
    if (!status)
        status = race_kinds(m, row, reason);
    progress_end(&m->bench->progress);
    race_leave(&m->race);
    return status;
}

/* Measures all contestants with that many threads. All results but speeds are taken from `known`,
 * if it is not NULL. */
static enum status play_threads(struct matrix *m, unsigned threads, const struct matrix_row *known,
                                struct reason *reason)
{
    enum status status = STATUS_OK;
    bool gpu = matrix_entry_is_gpu(&m->entries.entry[0]);
    size_t step = gpu ? GPU_GROUP : m->entries.count;
    m->row_count = 0;
    for (size_t first = 0; first < m->entries.count && !status; first += step) {
        size_t last = first + step < m->entries.count ? first + step : m->entries.count;
        status = play_group(m, first, last, threads, known, reason);
    }
    return status;
}

/* --- a scene ---------------------------------------------------------------------------------- */

static enum status open_matrix(struct matrix *m, struct reason *reason)
{
    struct bench *bench = m->bench;
    enum status status = matrix_entries_make(bench, &m->entries, reason);
    if (status)
        return status;
    bool gpu = matrix_entry_is_gpu(&m->entries.entry[0]);
    m->count = bench_rays_count(bench, gpu ? OWN_RAYS_GPU : OWN_RAYS);
    m->race = (struct race){.bench = bench, .label = m->spec, .scene = m->scene};
    m->row = alloc_zeroed(2 * (CONTESTANTS + 1), sizeof *m->row);
    if (!m->row)
        return fail(reason, STATUS_MEMORY, "no memory");
    status = oracle_make(m->scene, &m->oracle, reason);
    if (!status)
        status = make_rays(m, reason);
    return status ? status : matrix_known_make(m, reason);
}

static void close_matrix(struct matrix *m)
{
    race_leave(&m->race);
    for (size_t i = 0; i < m->tree_count; i++)
        bvh_free(&m->tree[i].bvh);
    for (int kind = 0; kind < MATRIX_KINDS; kind++)
        free(m->ray[kind]);
    known_free(&m->sample);
    known_free(&m->any);
    known_free(&m->leak);
    free(m->few);
    free(m->hit);
    free(m->row);
    oracle_free(m->oracle);
}

static void count_wrong(const struct matrix *m)
{
    for (size_t i = 0; i < m->row_count; i++)
        if (m->row[i].judged && m->row[i].verdicts.wrong > 0)
            bench_worse(m->bench, EXIT_MISMATCH);
}

static enum status play(struct matrix *m, struct reason *reason)
{
    unsigned named = m->bench->engines.threads;
    bool gpu = matrix_entry_is_gpu(&m->entries.entry[0]);
    unsigned first = named ? named : 1, last = named || gpu ? first : 2;
    struct matrix_row *known = m->row + CONTESTANTS + 1;
    enum status status = STATUS_OK;
    for (unsigned threads = first; threads <= last && !status; threads++) {
        status = play_threads(m, threads, threads > first ? known : NULL, reason);
        if (status)
            return status;
        matrix_print(m, threads == first);
        count_wrong(m);
        memcpy(known, m->row, m->row_count * sizeof *known);
        known[m->row_count].entry = NULL;
    }
    return status;
}

/* Drops engines that were named and cannot run here. Prints a line for each. */
static void drop_absent(struct bench *bench)
{
    size_t kept = 0;
    for (size_t i = 0; i < bench->engine.count; i++) {
        const struct engine *engine = engines[bench->engine.index[i]];
        struct reason reason = {"no memory"};
        void *self = NULL;
        enum status status =
            engine->brute ? STATUS_OK : engine_open(engine, &bench->engines, &self, &reason);
        if (self)
            engine->close(self);
        bench_failed(bench, NULL, status, &reason);
        if (!status)
            bench->engine.index[kept++] = bench->engine.index[i];
    }
    bench->engine.count = kept;
}

static enum status bench_scene(struct bench *bench, const char *spec, const struct scene *scene,
                               struct reason *reason)
{
    static struct matrix m;
    m = (struct matrix){.bench = bench, .spec = spec, .scene = scene};
    enum status status = open_matrix(&m, reason);
    if (!status)
        status = play(&m, reason);
    close_matrix(&m);
    return status;
}

static int run(struct bench *bench)
{
    struct benchmark matrix = bench_matrix;
    drop_absent(bench);
    if (bench->code != EXIT_AGREE && bench->engine.count == 0)
        return bench->code;
    if (matrix_is_gpu(bench)) /* leaves out the largest scene */
        matrix.scenes = "scenes/fetched/dragon-11k.ply.gz;scenes/fetched/dragon-203k.ply.gz";
    bench_each(bench, &matrix);
    struct reason reason = {""};
    if (bench->svg_path)
        bench_failed(bench, NULL, matrix_plot(bench->svg_path, bench->rows, &reason), &reason);
    return bench->code;
}

const struct benchmark bench_matrix = {
    .name = "matrix",
    .shown = "no answer is WRONG",
    .refuted = "an answer is WRONG",
    .summary = "builders, layouts, storages, engines: speed, size, lines read, errors",
    .takes = "scene count rounds csv json svg seed engine layout store" BENCH_MACHINE BENCH_OUTSIDE
        BENCH_SCREEN,
    .about = "rays: prim from a pinhole, rand random, diff bounced off what prim rays hit; "
             "o-shad from what they hit to a light and o-rand ask for any hit. Speeds are "
             "multiples of Embree's by default (of engine vulkan: of its layout f32), 1 thread "
             "by the core's own time and 2 by the time on the wall, or --threads N; mean: "
             "geometric, of the first four. Engine cpu traces every eighth ray. Bytes per "
             "triangle: all that a traversal reads; of Embree what it holds without its buffers "
             "of vertices and indices, which only compact reads. Lines: bytes per ray in lines "
             "of 64, looked for and from beyond 48 KiB (12 ways) and 1 MiB (16 ways), by "
             "simulation. lost, wrong: of prim and rand rays, against the exact truth. allowed, "
             "WRONG: answers to these, to leak rays and to o-shad and o-rand rays in an allowed "
             "class, and those that no rounding of the engine's own formula explains: exit code 1 "
             "if there is any. Only what loses nothing and has none WRONG is worth using. --engine "
             "vulkan: every layout that loses nothing, or --layout. With --store and without "
             "--layout: on f32.",
    .scenes = "scenes/fetched/dragon-11k.ply.gz;scenes/fetched/dragon-203k.ply.gz;"
              "scenes/fetched/dragon-871k.ply.gz",
    .made = "terrain:k=6;terrain:k=8;terrain:k=9",
    .play = bench_scene,
    .run = run,
    .triangles = true,
    .alone = true,
};
