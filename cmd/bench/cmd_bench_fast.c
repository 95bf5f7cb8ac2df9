/* Engine fast against Embree's modes: single rays of four kinds, their speed and what they read. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "cmd/bench/cmd_bench.h"
#include "bench/measure/shadow_rays.h"
#include "bench/frames/turns.h"

#include "ref/base/command.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "ref/base/json_record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RAYS_OWN 100000
#define RIVALS   6

static const char *const kinds[] = {"primary", "random", "bounce", "shadow"};
#define KINDS ARRAY_COUNT(kinds)

struct rival {
    const char *name;
    const struct engine *engine; /* NULL: cannot run here */
    void *self;
    double mrays[BENCH_ROUNDS], ratio[BENCH_ROUNDS]; /* to the first rival of all, Embree */
    struct hit *hit;
    uint64_t bytes, missed;
};

struct contest {
    struct bench *bench;
    const char *spec;
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct rival rival[RIVALS];
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

/* Of one thread the core's own time: other work on the machine counts little. */
static double now_ns(const struct contest *c)
{
    struct timespec now;
    if (c->bench->engines.threads != 1)
        return (double)time_ns();
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

static struct job job_of(const struct contest *c, enum query query)
{
    return (struct job){.scene = &c->scene,
                        .packed = &c->packed,
                        .box = box_test_find("watertight"),
                        .tri = tri_test_find("woop"),
                        .query = query};
}

static enum status prepare(struct contest *c, enum query query, struct reason *reason)
{
    struct job job = job_of(c, query);
    enum status status = STATUS_OK;
    for (size_t i = 0; i < RIVALS && !status; i++)
        if (c->rival[i].engine)
            status = c->rival[i].engine->prepare(c->rival[i].self, &job, reason);
    return status;
}

/* From where primary rays hit to a light. */
static enum status make_shadow_rays(struct contest *c, struct reason *reason)
{
    const struct rival *fast = &c->rival[RIVALS - 1];
    struct trace_report report;
    struct ray *out = alloc_zeroed(c->count, sizeof *out);
    if (!out)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", c->count);
    enum status status =
        fast->engine->trace(fast->self, c->ray, c->count, fast->hit, &report, reason);
    if (!status)
        status = shadow_rays_make(&c->scene, c->ray, fast->hit, c->count, out, reason);
    if (!status)
        memcpy(c->ray, out, c->count * sizeof *out);
    free(out);
    return status;
}

static enum status make_rays(struct contest *c, size_t kind, struct reason *reason)
{
    bool shadow = kind == KINDS - 1;
    enum status status = ray_set_find(shadow ? "primary" : kinds[kind])
                             ->make(&c->scene, c->bench->seed, c->count, c->ray, reason);
    if (!status)
        status = prepare(c, QUERY_CLOSEST, reason);
    if (!status && shadow) {
        status = make_shadow_rays(c, reason);
        if (!status)
            status = prepare(c, QUERY_ANY, reason);
    }
    return status;
}

/* --- rounds
 * --------------------------------------------------------------------------------------- */

static enum status play(struct contest *c, size_t kind, struct reason *reason)
{
    struct rng rng = rng_make(c->bench->seed, kind);
    size_t order[RIVALS];
    turns_start(order, RIVALS);
    for (size_t round = 0; round <= c->bench->rounds; round++) { /* the first warms up */
        turns_next(&rng, order, RIVALS);
        for (size_t turn = 0; turn < RIVALS; turn++) {
            struct rival *r = &c->rival[order[turn]];
            struct trace_report report = {.ns = 0};
            if (!r->engine)
                continue;
            progress_step(&c->bench->progress, "%s, %s rays, %s, round %zu", c->spec, kinds[kind],
                          r->name, round);
            double start = now_ns(c);
            enum status status =
                r->engine->trace(r->self, c->ray, c->count, r->hit, &report, reason);
            double ns = now_ns(c) - start;
            if (status)
                return status;
            r->bytes = report.memory_bytes > r->bytes ? report.memory_bytes : r->bytes;
            if (round > 0)
                r->mrays[round - 1] = 1e3 * (double)c->count / ns;
        }
    }
    return STATUS_OK;
}

/* Rays that a rival misses and another one hits. */
static void count_missed(struct contest *c)
{
    for (size_t i = 0; i < RIVALS; i++)
        c->rival[i].missed = 0;
    for (size_t n = 0; n < c->count; n++) {
        bool hit = false;
        for (size_t i = 0; i < RIVALS; i++)
            hit = hit || (c->rival[i].engine && c->rival[i].hit[n].prim != ABI_NO_PRIM);
        for (size_t i = 0; i < RIVALS && hit; i++)
            if (c->rival[i].engine && c->rival[i].hit[n].prim == ABI_NO_PRIM)
                c->rival[i].missed++;
    }
}

static void print_rows(struct contest *c, size_t kind, double *log_ratio)
{
    size_t rounds = c->bench->rounds;
    for (size_t i = RIVALS; i-- > 0;) {
        struct rival *r = &c->rival[i];
        if (!r->engine)
            continue;
        for (size_t n = 0; n < rounds; n++)
            r->ratio[n] = c->rival[0].engine ? r->mrays[n] / c->rival[0].mrays[n] : (double)NAN;
        /* Embree is the last: a spread sorts its values. */
        struct spread ratio = spread_of(r->ratio, rounds), mrays = spread_of(r->mrays, rounds);
        log_ratio[i] += log(ratio.median);
        double bytes = (double)r->bytes / (double)c->scene.tri_count;
        printf("  %-8s %-14s %8.3f  %6.3f (%.3f-%.3f) %8.1f %8llu\n", kinds[kind], c->rival[i].name,
               mrays.median, ratio.median, ratio.least, ratio.most, bytes,
               (unsigned long long)r->missed);
        bench_row(
            c->bench, &bench_fast,
            json_record("scene=%s rays=%s engine=%s threads=%u triangles=%u mrays=%g ratio=%g "
                        "ratio_least=%g ratio_most=%g bytes_per_triangle=%g missed=%zu",
                        c->spec, kinds[kind], c->rival[i].name, c->bench->engines.threads,
                        c->scene.tri_count, mrays.median, ratio.median, ratio.least, ratio.most,
                        bytes, r->missed));
    }
}

static enum status play_kinds(struct contest *c, struct reason *reason)
{
    double log_ratio[RIVALS] = {0};
    for (size_t kind = 0; kind < KINDS; kind++) {
        enum status status = make_rays(c, kind, reason);
        if (!status)
            status = play(c, kind, reason);
        progress_end(&c->bench->progress);
        if (status)
            return status;
        count_missed(c);
        print_rows(c, kind, log_ratio);
    }
    for (size_t i = 1; i < RIVALS && c->rival[0].engine; i++)
        printf("  %-8s %-14s %8s  %6.3f\n", "mean", c->rival[i].name, "",
               exp(log_ratio[i] / (double)KINDS));
    return STATUS_OK;
}

/* --- a scene
 * -------------------------------------------------------------------------------------- */

static enum status open_contest(struct contest *c, struct reason *reason)
{
    const struct build_options build = {.leaf = 1};
    enum status status = scene_open(c->spec, c->bench->seed, &c->scene, reason);
    if (!status)
        status = bvh_build(builder_find("sah_sweep"), &c->scene, &build, &c->bvh, reason);
    if (!status)
        status = packed_make(layout_find("f32"), &c->bvh, &c->scene, &c->packed, reason);
    c->ray = alloc_zeroed(c->count, sizeof *c->ray);
    for (size_t i = 0; i < RIVALS && !status; i++) {
        struct rival *r = &c->rival[i];
        struct engine_options options = c->bench->engines;
        const struct engine *engine = engine_find(entries[i].engine);
        options.compact = entries[i].compact;
        options.avx512 = entries[i].avx512;
        options.alone = entries[i].alone;
        r->name = entries[i].name;
        r->hit = alloc_zeroed(c->count, sizeof *r->hit);
        status = r->hit && c->ray ? engine->open(&options, &r->self, reason) : STATUS_MEMORY;
        if (!status)
            r->engine = engine;
        else if (status == STATUS_UNSUPPORTED) {
            printf("  %s left out: %s\n", c->rival[i].name, reason->text);
            status = STATUS_OK;
        }
    }
    return status;
}

static void close_contest(struct contest *c)
{
    for (size_t i = 0; i < RIVALS; i++) {
        if (c->rival[i].engine)
            c->rival[i].engine->close(c->rival[i].self);
        free(c->rival[i].hit);
    }
    free(c->ray);
    packed_free(&c->packed);
    bvh_free(&c->bvh);
    scene_free(&c->scene);
}

static int run(struct bench *bench)
{
    static const char *const own[] = {"scenes/fetched/dragon-11k.ply.gz",
                                      "scenes/fetched/dragon-203k.ply.gz",
                                      "scenes/fetched/dragon-871k.ply.gz", NULL};
    static const char *const made[] = {"terrain:k=6", "terrain:k=8", "terrain:k=9", NULL};
    const char *spec[BENCH_SCENES];
    size_t count = bench_scenes(bench, own, spec);
    int code = EXIT_AGREE;
    if (count == 0)
        count = bench_scenes(bench, made, spec);
    if (bench->engines.threads == 0)
        bench->engines.threads = 1;
    printf("\nfast: %u thread%s, %s\n", bench->engines.threads,
           bench->engines.threads == 1 ? "" : "s",
           bench->engines.threads == 1 ? "the core's own time" : "time on the wall");
    for (size_t i = 0; i < count; i++) {
        struct contest c = {
            .bench = bench, .spec = spec[i], .count = bench_rays_count(bench, RAYS_OWN)};
        struct reason reason = {"no memory"};
        printf("%s\n", spec[i]);
        enum status status = open_contest(&c, &reason);
        if (!status && c.scene.tri_count == 0)
            status = fail(&reason, STATUS_INPUT, "no triangles");
        if (!status) {
            printf("  %-8s %-14s %8s  %-22s %8s %8s\n", "rays", "engine", "Mray/s",
                   "to embree (least-most)", "byte/tri", "missed");
            status = play_kinds(&c, &reason);
        }
        if (status) {
            bench_complain(spec[i], &reason);
            code = exit_worse(code, exit_of_status(status));
        }
        close_contest(&c);
    }
    return code;
}

const struct benchmark bench_fast = {
    .name = "fast",
    .summary = "engine fast against Embree, single rays of four kinds",
    .takes = "scene count rounds csv json seed threads",
    .about = "--threads 1 unless told otherwise: the core's own time, else time on the wall; the "
             "tree is sah_sweep's. Shadow rays go from primary hits to a light and ask for any "
             "hit. fast takes two rays at once in trees over 8 MB; 'fast alone' takes one, "
             "always. byte/tri: what the engine holds, of fast all that it reads; missed: rays "
             "that another one hits; mean: geometric, of the ratios.",
    .run = run,
    .alone = true,
};
