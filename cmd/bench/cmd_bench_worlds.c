/* Engine fast against Embree on a world: a mesh placed many times, four kinds of rays, their speed,
 * and the first of their answers judged. */
#include "bench/measure/bounce_rays.h"
#include "bench/measure/shadow_rays.h"
#include "cmd/bench/cmd_bench_race.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/judge/judge_world.h"
#include "ref/store.h"
#include "ref/two_level/packed_world.h"
#include "scenes/rays/rays.h"
#include "scenes/worlds/crowd.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RAYS_OWN      100000
#define INSTANCES_OWN 100000
#define FIRST_JUDGED  2000
#define CROWDING      1.5 /* size of an instance, over the cube's side for each */

enum { PRIMARY, RANDOM, BOUNCE, SHADOW, KINDS };
static const char *const kinds[KINDS] = {"primary", "random", "bounce", "shadow"};

static const char *const rivals[] = {"embree", "embree_robust", "fast"};
#define RIVALS ARRAY_COUNT(rivals)

struct world_race {
    struct bench *bench;
    const char *spec;
    struct world world;
    struct world_trees trees;
    struct packed_world packed;
    struct oracle *oracle;
    struct race race;
    struct ray *ray, *next;
    struct hit *hit[RIVALS];
    uint32_t *tag[RIVALS];
    size_t *judged; /* numbers of rays whose answers are judged */
    size_t count, judged_count;
    double size;            /* largest side of the world's box */
    double log_sum[RIVALS]; /* of the ratios so far */
};

/* --- the world ------------------------------------------------------------------------------ */

static enum status build(struct world_race *a, struct reason *reason)
{
    const struct build_options options = {.leaf = 1, .eps = BUILD_EPS_DEFAULT};
    const struct world_build how = {.top = builder_find("sah_sweep"),
                                    .bottom = builder_find("sah_sweep"),
                                    .top_options = options,
                                    .bottom_options = options};
    const struct layout *f32 = layout_find("f32");
    enum status status = world_trees_make(&a->world, &how, &a->trees, reason);
    if (!status)
        status =
            packed_world_make(&a->world, &a->trees, f32, f32, tri_stores[0], &a->packed, reason);
    if (!status)
        status = oracle_make_world(&a->world, &a->oracle, reason);
    return status;
}

static enum status make_world(struct world_race *a, const struct scene *scene,
                              struct reason *reason)
{
    uint32_t count = a->bench->instances ? (uint32_t)a->bench->instances : INSTANCES_OWN;
    enum status status =
        world_crowd_of(scene, count, CROWDING / cbrt(count), a->bench->seed, &a->world, reason);
    if (status)
        return status;
    progress_step(&a->bench->progress, "%s: building", a->spec);
    uint64_t start = time_ns();
    status = build(a, reason);
    progress_end(&a->bench->progress);
    if (status)
        return status;
    struct box box = scene_bounds(&a->trees.items);
    for (int k = 0; k < 3; k++)
        a->size = fmax(a->size, (double)box.hi[k] - (double)box.lo[k]);
    printf("%s: %u instances, %u triangles placed, trees and truth in %.1f s\n", a->spec,
           a->world.instance_count, world_tri_count(&a->world), (double)(time_ns() - start) * 1e-9);
    return STATUS_OK;
}

static enum status enter_all(struct world_race *a, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < RIVALS && !status; i++) {
        const struct contestant who = {.engine = engine_find(rivals[i]),
                                       .box = box_test_find("watertight"),
                                       .tri = tri_test_find("woop")};
        progress_step(&a->bench->progress, "%s: %s builds", a->spec, rivals[i]);
        status = race_add(&a->race, &who, &a->bench->engines, reason);
        progress_end(&a->bench->progress);
        if (status == STATUS_UNSUPPORTED) {
            screen_line(4, "  %s left out: %s\n", rivals[i], reason->text);
            status = STATUS_OK;
        }
    }
    for (size_t i = 0; i < a->race.count && !status; i++) {
        a->hit[i] = alloc_zeroed(a->count, sizeof *a->hit[i]);
        a->tag[i] = alloc_zeroed(a->count, sizeof *a->tag[i]);
        if (!a->hit[i] || !a->tag[i])
            status = fail(reason, STATUS_MEMORY, "no memory for %zu answers", a->count);
    }
    a->race.tag = a->tag[0];
    return status;
}

/* --- rays --------------------------------------------------------------------------------- */

/* Traces the rays with every contestant, untimed, each to its own arrays. */
static enum status trace_all(struct world_race *a, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < a->race.count && !status; i++) {
        struct trace_report report;
        a->race.tag = a->tag[i];
        status = race_trace(&a->race, &a->race.contestant[i], a->ray, a->count, a->hit[i], &report,
                            reason);
    }
    return status;
}

/* Replaces primary rays by what begins where they end. */
static enum status follow(struct world_race *a, size_t kind, struct reason *reason)
{
    const struct hit *hit = a->hit[a->race.count - 1]; /* fast: it runs everywhere */
    enum status status = trace_all(a, reason);
    if (!status && kind == SHADOW)
        status = shadow_rays_make(&a->trees.items, a->ray, hit, a->count, a->next, reason);
    else if (!status)
        status = bounce_rays_make(&a->world, a->size, a->bench->seed, a->ray, hit, a->count,
                                  a->next, reason);
    if (!status)
        memcpy(a->ray, a->next, a->count * sizeof *a->ray);
    return status;
}

/* Primary and random rays go by the boxes of the instances. */
static enum status make_rays(struct world_race *a, size_t kind, struct reason *reason)
{
    const char *set = kind == RANDOM ? "random" : "primary";
    enum status status =
        ray_set_make(ray_set_find(set), &a->trees.items, a->bench->seed, a->count, a->ray, reason);
    if (!status)
        status = race_prepare(&a->race, QUERY_CLOSEST, reason);
    if (!status && (kind == BOUNCE || kind == SHADOW))
        status = follow(a, kind, reason);
    if (!status && kind == SHADOW)
        status = race_prepare(&a->race, QUERY_ANY, reason);
    return status;
}

/* --- results ------------------------------------------------------------------------------ */

/* True if two engines differ: one hits and the other misses, or of nearest hits another triangle
 * is nearest. */
static bool differ(const struct world_race *a, enum query query, size_t n)
{
    const uint32_t first = a->hit[0][n].prim;
    bool differs = false;
    for (size_t k = 1; k < a->race.count; k++) {
        const uint32_t prim = a->hit[k][n].prim;
        differs = differs || (prim == ABI_NO_PRIM) != (first == ABI_NO_PRIM) ||
                  (query == QUERY_CLOSEST && prim != first);
    }
    return differs;
}

/* Chooses the first rays, and all about which two engines differ. */
static void choose(struct world_race *a, enum query query)
{
    a->judged_count = 0;
    for (size_t n = 0; n < a->count; n++)
        if (n < FIRST_JUDGED || differ(a, query, n))
            a->judged[a->judged_count++] = n;
}

/* Counts the WRONG ones of the chosen answers of contestant i. */
static enum status judge_chosen(struct world_race *a, size_t i, enum query query, size_t *wrong,
                                struct reason *reason)
{
    const struct contestant *who = &a->race.contestant[i];
    const struct model model = engine_model(who->engine, who->self, who->tri);
    struct judge *judge;
    enum status status = judge_make(a->oracle, &model, query, &judge, reason);
    *wrong = 0;
    for (size_t k = 0; k < a->judged_count && !status; k++) {
        const size_t n = a->judged[k];
        struct oracle_answer truth;
        struct judgement out;
        progress_step(&a->bench->progress, "%s: judging %s", a->spec, who->engine->name);
        status = oracle_closest_world(a->oracle, ORACLE_AUTO, ORACLE_CLOSED, &a->ray[n], NULL, 1, 1,
                                      &truth, NULL, reason);
        if (!status)
            status = judge_world_answer(judge, &a->ray[n], ray_mode_all(), &truth, &a->hit[i][n],
                                        a->tag[i][n], &out);
        *wrong += !status && out.verdict == VERDICT_WRONG;
    }
    judge_free(judge);
    return status;
}

static void print_row(struct world_race *a, size_t kind, size_t i, size_t wrong)
{
    struct contestant *who = &a->race.contestant[i];
    const size_t rounds = a->bench->rounds;
    const bool based = a->race.contestant[0].engine->library;
    struct spread ratio = spread_of(who->ratio, rounds), mrays = spread_of(who->mrays, rounds);
    if (!based)
        ratio = (struct spread){NAN, NAN, NAN};
    a->log_sum[i] += log(ratio.median);
    const size_t missed = race_missed(&a->race, a->count, i);
    printf("  %-8s %-14s %8.3f  %6.3f (%.3f-%.3f) %8zu %8zu\n", kinds[kind], who->engine->name,
           mrays.median, ratio.median, ratio.least, ratio.most, missed, wrong);
    if (wrong > 0)
        bench_worse(a->bench, EXIT_MISMATCH);
    bench_row(
        a->bench, &bench_worlds,
        json_record("scene=%s instances=%u triangles=%u rays=%s engine=%s threads=%u mrays=%g "
                    "ratio=%g ratio_least=%g ratio_most=%g missed=%zu judged=%zu wrong=%zu",
                    a->spec, a->world.instance_count, world_tri_count(&a->world), kinds[kind],
                    who->engine->name, a->bench->engines.threads, mrays.median, ratio.median,
                    ratio.least, ratio.most, missed, a->judged_count, wrong));
}

static enum status play_kind(struct world_race *a, size_t kind, struct reason *reason)
{
    const enum query query = kind == SHADOW ? QUERY_ANY : QUERY_CLOSEST;
    enum status status = make_rays(a, kind, reason);
    if (!status)
        status = race_run(&a->race, kind == SHADOW ? QUERY_ANY : QUERY_CLOSEST, a->ray, a->count,
                          reason);
    if (!status)
        status = trace_all(a, reason);
    if (!status)
        choose(a, query);
    for (size_t i = a->race.count; i-- > 0 && !status;) {
        size_t wrong;
        status = judge_chosen(a, i, query, &wrong, reason);
        progress_end(&a->bench->progress);
        if (!status)
            print_row(a, kind, i, wrong);
    }
    return status;
}

static enum status play(struct world_race *a, const struct scene *scene, struct reason *reason)
{
    enum status status = make_world(a, scene, reason);
    a->ray = alloc_zeroed(a->count, sizeof *a->ray);
    a->next = alloc_zeroed(a->count, sizeof *a->next);
    a->judged = alloc_zeroed(a->count, sizeof *a->judged);
    if (!status && (!a->ray || !a->next || !a->judged))
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", a->count);
    if (!status)
        status = enter_all(a, reason);
    if (status)
        return status;
    puts("  rays     engine           Mray/s  to embree (least-most)   missed    WRONG");
    for (size_t kind = 0; kind < KINDS && !status; kind++)
        status = play_kind(a, kind, reason);
    for (size_t i = 1; i < a->race.count && a->race.contestant[0].engine->library && !status; i++)
        printf("  %-8s %-14s %8s  %6.3f\n", "mean", a->race.contestant[i].engine->name, "",
               exp(a->log_sum[i] / (double)KINDS));
    return status;
}

static enum status bench_scene(struct bench *bench, const char *spec, const struct scene *scene,
                               struct reason *reason)
{
    static struct world_race a;
    a = (struct world_race){
        .bench = bench, .spec = spec, .count = bench_rays_count(bench, RAYS_OWN)};
    a.race = (struct race){.bench = bench,
                           .label = spec,
                           .world = &a.world,
                           .packed_world = &a.packed,
                           .core_time = bench->engines.threads == 1};
    enum status status = play(&a, scene, reason);
    race_leave(&a.race);
    for (size_t i = 0; i < RIVALS; i++) {
        free(a.hit[i]);
        free(a.tag[i]);
    }
    free(a.ray);
    free(a.next);
    free(a.judged);
    oracle_free(a.oracle);
    packed_world_free(&a.packed);
    world_trees_free(&a.trees);
    world_free(&a.world);
    return status;
}

static int run(struct bench *bench)
{
    return bench_on_core(bench, &bench_worlds);
}

const struct benchmark bench_worlds = {
    .name = "worlds",
    .shown = "times; of those judged no answer is WRONG",
    .refuted = "an answer is WRONG",
    .summary = "engine fast against Embree on a mesh placed many times",
    .takes = "scene count rounds csv json seed threads instances",
    .about =
        "each scene is a mesh: --instances of it, turned, fill a cube. --threads 1 unless told "
        "otherwise: the core's own time, else time on the wall; all trees are sah_sweep's, "
        "Embree's its own. Bounces leave primary hits, shadow rays go from them to a light and "
        "ask for any hit. missed: rays that another one hits; WRONG: of the first 2000 answers and "
        "of all about which two engines differ; mean: geometric, of the ratios.",
    .scenes = "scenes/fetched/dragon-11k.ply.gz",
    .made = "terrain:k=6",
    .play = bench_scene,
    .run = run,
    .triangles = true,
    .alone = true,
};
