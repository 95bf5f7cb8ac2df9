/* Speed against error: every engine, layout and triangle test on the same rays. Each answer is
 * judged against the exact truth. */
#include "cmd/bench/cmd_bench_error.h"

#include "ref/base/command.h"
#include "scenes/rays/rays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OWN_RAYS 65536
/* Below this many ray-triangle pairs per ray set, brute force finds the truth; above, the oracle's
 * own tree is faster. */
#define BRUTE_PAIRS 1000000000u

static const char *const own_sets[] = {"random", "edges", NULL};

/* One scene being measured. */
struct error_field {
    struct bench *bench;
    const struct scene *scene;
    struct oracle *oracle;
    struct bvh bvh;
    struct race race;
    struct known_rays leak[LEAK_TARGETS];
    struct hit *hit; /* room for the largest number of rays */
};

static enum status decide(const struct error_field *field, struct known_rays *known,
                          struct reason *reason)
{
    return known_decide(field->oracle, field->scene, field->bench->engines.threads, BRUTE_PAIRS,
                        known, reason);
}

/* Makes rays that must hit if the mesh is closed. An open mesh gets no rays, and page->no_leaks is
 * the reason. */
static enum status make_leak_rays(struct error_field *field, size_t count, struct error_page *page,
                                  struct reason *reason)
{
    for (int target = 0; target < LEAK_TARGETS; target++) {
        struct known_rays *known = &field->leak[target];
        enum status status = known_alloc(count, known, reason);
        if (status)
            return status;
        progress_step(&field->bench->progress, "%s: rays from inside", page->scene);
        status = leak_rays_make(field->oracle, field->scene, (enum leak_target)target,
                                field->bench->seed, count, known->ray, &page->no_leaks);
        if (status == STATUS_INPUT) {
            known_free(known);
            return STATUS_OK;
        }
        if (status == STATUS_OK)
            status = decide(field, known, reason);
        if (status)
            return status;
        page->leak_rays[target] = count;
        if (known_hits(known) != count)
            return fail(reason, STATUS_DEVICE, "%s: %zu rays from inside a closed mesh do not hit",
                        page->scene, count - known_hits(known));
    }
    return STATUS_OK;
}

static enum status judge_rays(const struct error_field *field, const struct contestant *c,
                              const struct known_rays *known, const struct hit *hit,
                              struct error_row *row, struct reason *reason)
{
    return known_judge(field->oracle, known, c, QUERY_CLOSEST, hit, &row->verdicts, reason);
}

/* Counts the leaks of one contestant, and the errors of what it answered when it was timed. */
static enum status measure(const struct error_field *field, const struct contestant *c,
                           const struct known_rays *known, struct error_row *row,
                           struct reason *reason)
{
    enum status status = STATUS_OK;
    struct trace_report report;
    for (int target = 0; target < LEAK_TARGETS && status == STATUS_OK; target++) {
        const struct known_rays *leak = &field->leak[target];
        if (leak->count)
            status = known_trace(leak, c, field->hit, &report, reason);
        if (leak->count && status == STATUS_OK)
            status = judge_rays(field, c, leak, field->hit, row, reason);
        for (size_t i = 0; i < leak->count && status == STATUS_OK; i++)
            row->leak[target] += field->hit[i].prim == ABI_NO_PRIM;
    }
    if (status == STATUS_OK)
        status = error_sum_make(field->oracle, field->scene, known->ray, known->truth, c->answer,
                                known->count, &row->sum, reason);
    if (status == STATUS_OK)
        status = judge_rays(field, c, known, c->answer, row, reason);
    return status;
}

/* Returns a row with the contestant's members and bytes, without measurements. */
static struct error_row row_of(const struct contestant *c)
{
    struct error_row row = {.engine = c->engine, .layout = c->layout};
    bool own = c->layout || strstr(c->engine->name, "brute");
    row.tri = own ? c->tri : NULL;
    row.box = c->layout ? c->box : NULL;
    row.judged = known_is_judged(c);
    if (c->layout) {
        row.node_bytes = packed_node_bytes(&c->packed);
        row.item_bytes = packed_item_bytes(&c->packed);
    }
    return row;
}

static void take_speeds(struct error_field *field, struct error_page *page)
{
    size_t rounds = (size_t)field->bench->rounds;
    for (size_t i = 0; i < page->row_count; i++) {
        struct contestant *c = &field->race.contestant[i];
        struct error_row *row = &page->row[i];
        row->mrays = spread_of(c->mrays, rounds);
        row->ratio = spread_of(c->ratio, rounds);
        row->base = race_base_name(&field->race, c);
        row->memory_bytes = c->memory_bytes;
        row->node_bytes = c->layout ? row->node_bytes : c->node_bytes;
        row->boxes = c->boxes ? (double)c->boxes / (double)page->ray_count : NAN;
        row->tris = c->tris ? (double)c->tris / (double)page->ray_count : NAN;
        row->boxes_to_f32 = row->tris_to_f32 = NAN;
    }
    for (size_t i = 0; i < page->row_count; i++)
        for (size_t k = 0; k < page->row_count; k++) {
            struct error_row *row = &page->row[i];
            const struct error_row *f32 = &page->row[k];
            if (!row->layout || f32->engine != row->engine || f32->tri != row->tri ||
                f32->box != row->box || f32->layout != layouts[0])
                continue;
            row->boxes_to_f32 = row->boxes / f32->boxes;
            row->tris_to_f32 = row->tris / f32->tris;
        }
}

/* Fills one page: the speeds of the race, and the errors. */
static enum status play(struct error_field *field, const struct ray_set *set,
                        struct error_page *page, struct reason *reason)
{
    struct known_rays known;
    char label[96];
    page->rays = set->name;
    enum status status = known_alloc(page->ray_count, &known, reason);
    if (status)
        return status;
    snprintf(label, sizeof label, "%.60s, %s rays", page->scene, set->name);
    field->race.label = label;
    progress_step(&field->bench->progress, "%s: exact answers", label);
    status =
        ray_set_make(set, field->scene, field->bench->seed, page->ray_count, known.ray, reason);
    if (status == STATUS_OK)
        status = decide(field, &known, reason);
    page->exact_hits = status ? 0 : known_hits(&known);
    if (status == STATUS_OK)
        status = race_run(&field->race, QUERY_CLOSEST, known.ray, known.count, reason);
    for (size_t i = 0; i < field->race.count && status == STATUS_OK; i++) {
        const struct contestant *c = &field->race.contestant[i];
        progress_step(&field->bench->progress, "%s: errors of %s", label, c->engine->name);
        page->row[i] = row_of(c);
        status = measure(field, c, &known, &page->row[i], reason);
        page->row_count = i + 1;
    }
    if (status == STATUS_OK)
        take_speeds(field, page);
    progress_end(&field->bench->progress);
    known_free(&known);
    return status;
}

static void count_wrong(struct bench *bench, const struct error_page *page)
{
    for (size_t i = 0; i < page->row_count; i++)
        if (page->row[i].judged && page->row[i].verdicts.wrong > 0)
            bench_worse(bench, EXIT_MISMATCH);
    if (page->exact_hits == 0) {
        puts("vacuous: no ray hits anything");
        bench_worse(bench, EXIT_MISMATCH);
    }
}

static enum status play_sets(struct error_field *field, const char *spec, struct reason *reason)
{
    static struct error_page page;
    const void *set[LIST_MOST];
    struct bench *bench = field->bench;
    page = (struct error_page){.scene = spec,
                               .ray_count = bench_rays_count(bench, OWN_RAYS),
                               .tri_count = field->scene->tri_count};
    enum status status = make_leak_rays(field, (page.ray_count + 1) / 2, &page, reason);
    if (status == STATUS_OK)
        race_enter(&field->race);
    size_t sets = bench_members(TABLE_RAY_SETS, &bench->rays, own_sets, set);
    for (size_t s = 0; s < sets && status == STATUS_OK; s++) {
        status = play(field, set[s], &page, reason);
        if (status)
            return status;
        error_print(bench, &page);
        count_wrong(bench, &page);
    }
    return status;
}

static enum status play_scene(struct bench *bench, const char *spec, const struct scene *scene,
                              struct reason *reason)
{
    static struct error_field field;
    field = (struct error_field){
        .bench = bench,
        .scene = scene,
        .race = {.bench = bench, .label = spec, .scene = scene, .bvh = &field.bvh},
        .hit = alloc_zeroed(bench_rays_count(bench, OWN_RAYS), sizeof *field.hit)};
    enum status status =
        field.hit ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for the answers");
    if (status == STATUS_OK)
        status = oracle_make(scene, &field.oracle, reason);
    if (status == STATUS_OK)
        status = bench_tree_make(bench, scene, &field.bvh, reason);
    if (status == STATUS_OK)
        status = play_sets(&field, spec, reason);
    race_leave(&field.race);
    for (int target = 0; target < LEAK_TARGETS; target++)
        known_free(&field.leak[target]);
    bvh_free(&field.bvh);
    oracle_free(field.oracle);
    free(field.hit);
    return status;
}

static int run(struct bench *bench)
{
    struct reason reason = {""};
    char driver[96];
    error_driver(&bench->engines, driver, sizeof driver);
    bench_each(bench, &bench_error);
    if (bench->svg_path)
        bench_failed(bench, NULL, error_plot(bench, driver, &reason), &reason);
    return bench->code;
}

static const char about[] =
    "speed beside errors, on the same rays. Truth is exact (ref/oracle).\n"
    "  lost, phantom, wrong id  answers that differ from the exact truth, without any "
    "tolerance, per million rays; <x: none of N, at most 3/N with 95 % confidence\n"
    "  leaks                    misses of rays from inside a closed mesh, aimed at its "
    "edges and vertices, per million\n"
    "  named, WRONG, err/E      answers in an allowed class; answers that no rounding "
    "of the engine's own formula explains; the largest error of t over its proven "
    "bound; of leak rays, too\n"
    "  forward                  |t - exact t| |d| / (u M): M is the triangle's size "
    "seen from the origin, max |v - o|; u = 2^-24\n"
    "  plane                    distance of the hit point from the triangle's plane / "
    "(u M)\n"
    "  boxes, tris              tests per ray over those of f32 nodes with the same "
    "tests\n"
    "With --svg: speed against wrong answers, leaks and forward error.";

const struct benchmark bench_error = {
    .name = "error",
    .shown = "no answer is WRONG",
    .refuted = "an answer is WRONG, or no ray hits anything",
    .summary = "engines, layouts and triangle tests: speed against error, exactly measured",
    .takes = "scene count rounds csv json seed engine layout tri box rays svg bvh" BENCH_MACHINE
        BENCH_OUTSIDE BENCH_SCREEN,
    .about = about,
    .scenes = "sphere:n=32;scenes/fetched/dragon-11k.ply.gz;needles",
    .play = play_scene,
    .run = run,
};
