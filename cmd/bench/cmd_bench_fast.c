/* Engine fast against Embree's modes: single rays of four kinds, their speed and the engines'
 * bytes. */
#include "cmd/bench/cmd_bench_race.h"
#include "cmd/common/cmd_screen.h"
#include "bench/measure/shadow_rays.h"

#include "ref/base/command.h"
#include "bench/measure/small_parts.h"
#include "ref/engines/embree_modes.h"
#include "ref/store.h"
#include "scenes/rays/rays.h"
#include "ref/base/json_record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RAYS_OWN 100000
#define RIVALS   16

static const char *const kinds[] = {"primary", "random", "bounce", "shadow"};
#define KINDS ARRAY_COUNT(kinds)

/* How an engine is opened. */
struct fast_entry {
    char name[BENCH_ENGINE_NAME];
    const struct engine *engine;
    const struct tri_store *store; /* NULL: indexed */
    bool compact, avx512, alone;
};

struct contest {
    struct bench *bench;
    const char *spec;
    const struct scene *scene;
    struct bvh bvh;
    struct race race;
    struct fast_entry entry[RIVALS];            /* per contestant */
    struct hit *hit;                            /* scratch */
    double log_ratio[RIVALS], log_warm[RIVALS]; /* of all kinds, summed */
    size_t missed[RIVALS];
    bool embree; /* the first contestant is Embree, which the others are compared with */
    struct ray *ray;
    size_t count;
};

/* The contestants of its own. */
static const struct {
    const char *name, *engine;
    bool compact, avx512, alone;
    const char *store; /* NULL: indexed */
} own[] = {
    {"embree", "embree", false, false, false, NULL},
    {"embree avx512", "embree", false, true, false, NULL},
    {"embree robust", "embree_robust", false, false, false, NULL},
    {"embree compact", "embree", true, false, false, NULL},
    {"embree high", "embree_high", false, false, false, NULL},
    {"embree 16", "embree_16", false, false, false, NULL},
    {"fast tiny", "fast_small", false, false, false, "quantised"},
    {"fast small", "fast_small", false, false, false, NULL},
    {"fast alone", "fast", false, false, true, NULL},
    {"fast", "fast", false, false, false, NULL},
};

/* Replaces the primary rays by rays from their hits to a light. */
static enum status make_shadow_rays(struct contest *c, struct reason *reason)
{
    const struct contestant *who = &c->race.contestant[0]; /* Embree, if it can run */
    struct trace_report report;
    struct ray *out = alloc_zeroed(c->count, sizeof *out);
    if (!out)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", c->count);
    enum status status = who->engine->trace(who->self, c->ray, c->count, c->hit, &report, reason);
    if (!status)
        status = shadow_rays_make(c->scene, c->ray, c->hit, c->count, out, reason);
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

/* A spread that nothing is compared with has no numbers. */
static struct spread ratio_of(const struct contest *c, double *ratio)
{
    return c->embree ? spread_of(ratio, (size_t)c->bench->rounds) : (struct spread){NAN, NAN, NAN};
}

/* What it holds; NAN: not known. */
static double held(const struct contest *c, const struct contestant *who)
{
    return who->memory_bytes ? (double)who->memory_bytes / (double)c->scene->tri_count
                             : (double)NAN;
}

static void print_row(struct contest *c, size_t kind, size_t i)
{
    const size_t rounds = (size_t)c->bench->rounds;
    struct contestant *r = &c->race.contestant[i];
    const struct spread ratio = ratio_of(c, r->ratio), warm_ratio = ratio_of(c, r->warm_ratio);
    const struct spread mrays = spread_of(r->mrays, rounds), warm = spread_of(r->warm, rounds);
    const size_t missed = race_missed(&c->race, c->count, i);
    const char *name = c->entry[i].name;
    c->log_ratio[i] += log(ratio.median);
    c->log_warm[i] += log(warm_ratio.median);
    c->missed[i] += missed;
    printf("  %-7s %-16.16s %7.3f %5.2f (%.2f-%.2f) %7.3f %5.2f (%.2f-%.2f)\n", kinds[kind], name,
           mrays.median, ratio.median, ratio.least, ratio.most, warm.median, warm_ratio.median,
           warm_ratio.least, warm_ratio.most);
    bench_row(c->bench, &bench_fast,
              json_record("scene=%s rays=%s engine=%s called=%s threads=%u triangles=%u mrays=%g "
                          "ratio=%g ratio_least=%g ratio_most=%g warm_mrays=%g warm=%g "
                          "warm_least=%g warm_most=%g bytes_per_triangle=%g missed=%zu",
                          c->spec, kinds[kind], name, engine_called(r->engine, r->self),
                          c->bench->engines.threads, c->scene->tri_count, mrays.median,
                          ratio.median, ratio.least, ratio.most, warm.median, warm_ratio.median,
                          warm_ratio.least, warm_ratio.most, held(c, r), missed));
}

static enum status play_kind(struct contest *c, size_t kind, struct reason *reason)
{
    enum status status = make_rays(c, kind, reason);
    if (!status)
        status = race_run(&c->race, kind == KINDS - 1 ? QUERY_ANY : QUERY_CLOSEST, c->ray, c->count,
                          reason);
    progress_end(&c->bench->progress);
    for (size_t i = c->race.count; i-- > 0 && !status;)
        print_row(c, kind, i);
    return status;
}

static void print_ends(struct contest *c)
{
    for (size_t i = c->race.count; i-- > 1 && c->embree;)
        printf("  %-7s %-16.16s %7s %5.2f %11s %7s %5.2f\n", "mean", c->entry[i].name, "",
               exp(c->log_ratio[i] / (double)KINDS), "", "", exp(c->log_warm[i] / (double)KINDS));
    puts("  engine           byte/tri  missed  called");
    for (size_t i = c->race.count; i-- > 0;) {
        const struct contestant *r = &c->race.contestant[i];
        char bytes[32] = "-";
        if (r->memory_bytes)
            snprintf(bytes, sizeof bytes, "%.1f", held(c, r));
        printf("  %-16.16s %8s %7zu  %s\n", c->entry[i].name, bytes, c->missed[i],
               engine_called(r->engine, r->self));
    }
}

/* What the bytes of engine fast_small hold, where it is a contestant. */
static enum status print_parts(const struct contest *c, struct reason *reason)
{
    struct fast_tree tree;
    bool is = false;
    for (size_t i = 0; i < c->race.count; i++)
        is = is || (c->entry[i].engine == engine_find("fast_small") && !c->entry[i].store);
    enum status status = is ? fast_make_small(&c->bvh, c->scene, &tree, reason) : STATUS_OK;
    if (!is || status)
        return status;
    const struct small_parts parts = small_parts_count(&tree);
    double held = 0, least = 0;
    puts("  fast small       byte/tri  least");
    for (int i = 0; i < SMALL_PARTS; i++) {
        printf("  %-16s %8.2f %6.2f\n", small_part_names[i],
               parts.held[i] / (double)c->scene->tri_count,
               parts.least[i] / (double)c->scene->tri_count);
        held += parts.held[i] / (double)c->scene->tri_count;
        least += parts.least[i] / (double)c->scene->tri_count;
    }
    printf("  %-16s %8.2f %6.2f\n", "all", held, least);
    fast_free(&tree);
    return STATUS_OK;
}

static const struct engine *engine_of(const char *name)
{
    for (size_t i = 0; embree_modes[i]; i++)
        if (strcmp(embree_modes[i]->name, name) == 0)
            return embree_modes[i];
    return engine_find(name);
}

/* Enters an engine, or prints why it is left out: also a storage of which the scene is not. */
static enum status enter(struct contest *c, const struct fast_entry *entry, bool named,
                         struct reason *reason)
{
    struct engine_options options = c->bench->engines;
    const struct contestant who = {.engine = entry->engine,
                                   .layout = entry->engine->needs_packed ? layouts[0] : NULL,
                                   .box = box_test_find("watertight"),
                                   .tri = tri_test_find("woop"),
                                   .store = entry->store};
    if (c->race.count == RIVALS)
        return fail(reason, STATUS_LIMIT, "more than %d contestants", RIVALS);
    options.compact = entry->compact;
    options.avx512 = entry->avx512;
    options.alone = entry->alone;
    c->entry[c->race.count] = *entry;
    enum status status = race_add(&c->race, &who, &options, reason);
    if (status == STATUS_UNSUPPORTED || (status == STATUS_LIMIT && entry->store)) {
        screen_line(4, "  %s left out: %s\n", entry->name, reason->text);
        if (named)
            bench_worse(c->bench, EXIT_SKIPPED);
        status = STATUS_OK;
    }
    return status;
}

static enum status enter_own(struct contest *c, size_t count, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        struct fast_entry entry = {.engine = engine_of(own[i].engine),
                                   .compact = own[i].compact,
                                   .avx512 = own[i].avx512,
                                   .alone = own[i].alone};
        entry.store = own[i].store ? tri_store_find(own[i].store) : NULL;
        snprintf(entry.name, sizeof entry.name, "%s", own[i].name);
        status = enter(c, &entry, false, reason);
        if (i == 0)
            c->embree = c->race.count > 0;
    }
    return status;
}

/* Enters Embree, and the engines that the user named. */
static enum status enter_named(struct contest *c, struct reason *reason)
{
    const struct list *list = &c->bench->engine;
    enum status status = enter_own(c, 1, reason);
    for (size_t i = 0; i < list->count && !status; i++) {
        struct fast_entry entry = {.engine = engines[list->index[i]]};
        bench_engine_name(entry.engine, entry.name);
        if (entry.engine != c->entry[0].engine || !c->embree)
            status = enter(c, &entry, true, reason);
    }
    if (!status && c->race.count == 0)
        status = fail(reason, STATUS_UNSUPPORTED, "no engine that was named can run here");
    return status;
}

static enum status enter_all(struct contest *c, struct reason *reason)
{
    return c->bench->engine.count ? enter_named(c, reason) : enter_own(c, ARRAY_COUNT(own), reason);
}

static enum status open_contest(struct contest *c, struct reason *reason)
{
    const struct build_options build = {.leaf = 1};
    enum status status = bvh_build(builder_find("sah_sweep"), c->scene, &build, &c->bvh, reason);
    if (!status)
        c->ray = alloc_zeroed(c->count, sizeof *c->ray);
    if (!status)
        c->hit = alloc_zeroed(c->count, sizeof *c->hit);
    if (!status && !(c->ray && c->hit))
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
                                  .warm = true,
                                  .core_time = bench->engines.threads == 1}};
    printf("%s\n", spec);
    enum status status = open_contest(&c, reason);
    if (!status)
        puts("  rays    engine            Mray/s to embree (span)    warm to embree (span)");
    for (size_t kind = 0; kind < KINDS && !status; kind++)
        status = play_kind(&c, kind, reason);
    if (!status) {
        print_ends(&c);
        status = print_parts(&c, reason);
    }
    race_leave(&c.race);
    free(c.hit);
    free(c.ray);
    bvh_free(&c.bvh);
    return status;
}

static int run(struct bench *bench)
{
    const struct list *list = &bench->engine;
    for (size_t i = 0; i < list->count; i++)
        if (engines[list->index[i]]->gpu || engines[list->index[i]]->brute) {
            fprintf(stderr, "raydiff bench: --engine %s: %s\n", engines[list->index[i]]->name,
                    engines[list->index[i]]->gpu ? "runs on a GPU: see raydiff bench matrix"
                                                 : "tests every triangle");
            return EXIT_USAGE;
        }
    return bench_on_core(bench, &bench_fast);
}

const struct benchmark bench_fast = {
    .name = "fast",
    .shown = "times; missed hits are counted, not judged",
    .summary = "engine fast against Embree, single rays of four kinds",
    .takes = "scene count rounds csv json seed threads engine peer-time peer-memory",
    .about = "--threads 1 unless told otherwise: the core's own time, else time on the wall; the "
             "tree is sah_sweep's. Two speeds: in turns, with the others' data in the caches; and "
             "warm, the last of three more traces in a row. Each is called as its own users would "
             "(called): its rays are filled before, its answers read behind. --engine races those "
             "engines against embree, such as inside:FILE.so. Shadow rays go from primary hits to "
             "a light and ask for any hit. fast takes rays together that are alike, and others "
             "in turns; 'fast alone' takes one, always; 'fast small' has a smaller tree. byte/tri: "
             "what the engine holds, of fast all that it reads; least: the least that a code of "
             "each leaf on its own could take (an entropy); missed: rays that another one hits; "
             "mean: geometric, of the ratios.",
    .scenes = "scenes/fetched/dragon-11k.ply.gz;scenes/fetched/dragon-203k.ply.gz;"
              "scenes/fetched/dragon-871k.ply.gz",
    .made = "terrain:k=6;terrain:k=8;terrain:k=9",
    .play = bench_scene,
    .run = run,
    .triangles = true,
    .alone = true,
};
