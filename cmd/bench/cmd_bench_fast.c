/* Engine fast against Embree's modes: single rays of four kinds, their speed and the engines'
 * bytes. */
#include "cmd/bench/cmd_bench_race.h"
#include "cmd/common/cmd_screen.h"
#include "bench/measure/shadow_rays.h"

#include "ref/base/command.h"
#include "scenes/rays/rays.h"
#include "ref/base/json_record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RAYS_OWN 100000
#define RIVALS   6

static const char *const kinds[] = {"primary", "random", "bounce", "shadow"};
#define KINDS ARRAY_COUNT(kinds)

struct contest {
    struct bench *bench;
    const char *spec;
    const struct scene *scene;
    struct bvh bvh;
    struct race race;
    size_t entry[RIVALS]; /* index in `entries`, per contestant */
    struct hit *hit[RIVALS];
    struct ray *ray;
    size_t count;
};

/* How an engine is opened. */
struct fast_entry {
    const char *name, *engine;
    bool compact, avx512, alone;
};

static const struct fast_entry entries[RIVALS] = {
    {"embree", "embree", false, false, false},
    {"embree avx512", "embree", false, true, false},
    {"embree robust", "embree_robust", false, false, false},
    {"embree compact", "embree", true, false, false},
    {"fast alone", "fast", false, false, true},
    {"fast", "fast", false, false, false},
};

/* Traces the rays with contestant i, untimed. */
static enum status trace(struct contest *c, size_t i, struct reason *reason)
{
    const struct contestant *who = &c->race.contestant[i];
    struct trace_report report;
    return who->engine->trace(who->self, c->ray, c->count, c->hit[i], &report, reason);
}

/* Replaces the primary rays by rays from their hits to a light. */
static enum status make_shadow_rays(struct contest *c, struct reason *reason)
{
    size_t fast = c->race.count - 1; /* the last contestant; it runs everywhere */
    struct ray *out = alloc_zeroed(c->count, sizeof *out);
    if (!out)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", c->count);
    enum status status = trace(c, fast, reason);
    if (!status)
        status = shadow_rays_make(c->scene, c->ray, c->hit[fast], c->count, out, reason);
    if (!status)
        memcpy(c->ray, out, c->count * sizeof *out);
    free(out);
    return status;
}

static enum status make_rays(struct contest *c, size_t kind, struct reason *reason)
{
    bool shadow = kind == KINDS - 1;
    enum status status = ray_set_make(ray_set_find(shadow ? "primary" : kinds[kind]), c->scene,
                                      c->bench->seed, c->count, c->ray, reason);
    if (!status)
        status = race_prepare(&c->race, QUERY_CLOSEST, reason);
    if (!status && shadow) {
        status = make_shadow_rays(c, reason);
        if (!status)
            status = race_prepare(&c->race, QUERY_ANY, reason);
    }
    return status;
}

static void print_rows(struct contest *c, size_t kind, double *log_ratio)
{
    size_t rounds = c->bench->rounds;
    for (size_t i = c->race.count; i-- > 0;) {
        struct contestant *r = &c->race.contestant[i];
        struct spread ratio = spread_of(r->ratio, rounds), mrays = spread_of(r->mrays, rounds);
        if (c->entry[0] != 0) /* Embree cannot run here */
            ratio = (struct spread){NAN, NAN, NAN};
        log_ratio[i] += log(ratio.median);
        double bytes = (double)r->memory_bytes / (double)c->scene->tri_count;
        size_t missed = race_missed(&c->race, c->hit, c->count, i);
        const char *name = entries[c->entry[i]].name;
        printf("  %-8s %-14s %8.3f  %6.3f (%.3f-%.3f) %8.1f %8zu\n", kinds[kind], name,
               mrays.median, ratio.median, ratio.least, ratio.most, bytes, missed);
        bench_row(
            c->bench, &bench_fast,
            json_record("scene=%s rays=%s engine=%s threads=%u triangles=%u mrays=%g ratio=%g "
                        "ratio_least=%g ratio_most=%g bytes_per_triangle=%g missed=%zu",
                        c->spec, kinds[kind], name, c->bench->engines.threads, c->scene->tri_count,
                        mrays.median, ratio.median, ratio.least, ratio.most, bytes, missed));
    }
}

static enum status play_kinds(struct contest *c, struct reason *reason)
{
    double log_ratio[RIVALS] = {0};
    for (size_t kind = 0; kind < KINDS; kind++) {
        enum status status = make_rays(c, kind, reason);
        if (!status)
            status = race_run(&c->race, c->ray, c->count, c->hit[0], reason);
        progress_end(&c->bench->progress);
        for (size_t i = 0; i < c->race.count && !status; i++)
            status = trace(c, i, reason);
        if (status)
            return status;
        print_rows(c, kind, log_ratio);
    }
    for (size_t i = 1; i < c->race.count && c->entry[0] == 0; i++)
        printf("  %-8s %-14s %8s  %6.3f\n", "mean", entries[c->entry[i]].name, "",
               exp(log_ratio[i] / (double)KINDS));
    return STATUS_OK;
}

static enum status enter_all(struct contest *c, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < RIVALS && !status; i++) {
        struct engine_options options = c->bench->engines;
        const struct contestant who = {.engine = engine_find(entries[i].engine),
                                       .layout = layout_find("f32"),
                                       .box = box_test_find("watertight"),
                                       .tri = tri_test_find("woop")};
        options.compact = entries[i].compact;
        options.avx512 = entries[i].avx512;
        options.alone = entries[i].alone;
        c->entry[c->race.count] = i;
        status = race_add(&c->race, &who, &options, reason);
        if (status == STATUS_UNSUPPORTED) {
            screen_line(4, "  %s left out: %s\n", entries[i].name, reason->text);
            status = STATUS_OK;
        }
    }
    for (size_t i = 0; i < c->race.count && !status; i++) {
        c->hit[i] = alloc_zeroed(c->count, sizeof *c->hit[i]);
        if (!c->hit[i])
            status = fail(reason, STATUS_MEMORY, "no memory for %zu answers", c->count);
    }
    return status;
}

static enum status open_contest(struct contest *c, struct reason *reason)
{
    const struct build_options build = {.leaf = 1};
    enum status status = bvh_build(builder_find("sah_sweep"), c->scene, &build, &c->bvh, reason);
    if (!status)
        c->ray = alloc_zeroed(c->count, sizeof *c->ray);
    if (!status && !c->ray)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", c->count);
    return status ? status : enter_all(c, reason);
}

static enum status bench_scene(struct bench *bench, const char *spec, const struct scene *scene,
                               struct reason *reason)
{
    static struct contest c;
    c = (struct contest){.bench = bench,
                         .spec = spec,
                         .scene = scene,
                         .count = bench_rays_count(bench, RAYS_OWN),
                         .race = {.bench = bench,
                                  .label = spec,
                                  .scene = scene,
                                  .bvh = &c.bvh,
                                  .core_time = bench->engines.threads == 1}};
    printf("%s\n", spec);
    enum status status = open_contest(&c, reason);
    if (!status) {
        puts("  rays     engine           Mray/s  to embree (least-most) byte/tri   missed");
        status = play_kinds(&c, reason);
    }
    race_leave(&c.race);
    for (size_t i = 0; i < RIVALS; i++)
        free(c.hit[i]);
    free(c.ray);
    bvh_free(&c.bvh);
    return status;
}

static int run(struct bench *bench)
{
    return bench_on_core(bench, &bench_fast);
}

const struct benchmark bench_fast = {
    .name = "fast",
    .shown = "times; missed hits are counted, not judged",
    .summary = "engine fast against Embree, single rays of four kinds",
    .takes = "scene count rounds csv json seed threads",
    .about = "--threads 1 unless told otherwise: the core's own time, else time on the wall; the "
             "tree is sah_sweep's. Shadow rays go from primary hits to a light and ask for any "
             "hit. fast takes two rays at once in trees over 8 MB; 'fast alone' takes one, "
             "always. byte/tri: what the engine holds, of fast all that it reads; missed: rays "
             "that another one hits; mean: geometric, of the ratios.",
    .scenes = "scenes/fetched/dragon-11k.ply.gz;scenes/fetched/dragon-203k.ply.gz;"
              "scenes/fetched/dragon-871k.ply.gz",
    .made = "terrain:k=6;terrain:k=8;terrain:k=9",
    .play = bench_scene,
    .run = run,
    .triangles = true,
    .alone = true,
};
