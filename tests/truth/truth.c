/* The campaign of truth: many judged rays, every WRONG decided again by rationals.
 *   truth [--rays N] [--seed S] [--out DIR] [--driver D]
 * N rays of five sets on every scene; engines cpu and vulkan on layouts f32 and rf16, with mt (box
 * test robust) and woop (box test watertight), and embree_robust. The layouts as published, which
 * are known to be wrong, join with 1/500 of the rays: they show that WRONGs are found, decided
 * again and explained. The first of each signature and the smallest scene that still shows it go to
 * DIR. Exit: 0 nothing overturned and no WRONG of cpu or vulkan on f32 or rf16; 1 otherwise; 2 bad
 * input; 3 an engine failed; 4 no memory. */
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_progress.h"
#include "ref/base/command.h"
#include "ref/files/file.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/truth/play.h"

#include <stdlib.h>
#include <string.h>

static const char *const specs[] = {
    "soup:n=4000",
    "soup:n=4000,size=0.01,offset=1000",
    "soup:n=2000,offset=1e6",
    "grid:n=40",
    "grid:n=40,height=0,z=1",
    "needles:n=4000,aspect=1e4",
    "needles:n=2000,aspect=1e7,offset=100",
    "stack:n=500",
    "stack:n=300,copies=9,offset=1000",
    "cornell:n=6",
    "sphere:n=20",
    "flake",
    "terrain:k=6",
    "platonic",
    "scenes/fetched/assimp-wuson.obj",
    "scenes/fetched/utah-teapot.obj",
    "scenes/fetched/dragon-11k.ply.gz",
    "scenes/fetched/glmark2-bunny.obj",
};
static const char *const ray_names[] = {"random", "vertices", "edges", "corners", "axis"};

#define BATCH           250000u
#define PUBLISHED_SHARE 500u

struct truth_options {
    uint64_t rays, seed;
    const char *out;
    struct engine_options engines;
};

enum { GROUP_MT, GROUP_WOOP, GROUP_EMBREE, GROUP_PUBLISHED, GROUP_COUNT };

/* Contestants that share a line of the table. */
static const char *const group_names[GROUP_COUNT] = {"cpu, vulkan: mt", "cpu, vulkan: woop",
                                                     "embree_robust", "as published"};

struct truth_campaign {
    struct truth_options options;
    struct pool pool;
    struct tally tally;
    struct progress progress;
    struct play_result sum[GROUP_COUNT];
    size_t refused, unfinished, scenes, left_out;
    int code;
};

static void play_one(struct truth_campaign *c, const struct ground *ground,
                     const struct tally_contestant *who, int group)
{
    struct play_result result;
    struct reason reason = {""};
    progress_step(&c->progress, "%s, %s rays, %s %s %s", ground->spec, ground->rays,
                  who->engine->name, who->layout ? who->layout->name : "", who->tri->name);
    enum status status = play(ground, who, &c->pool, &c->tally, &result, &reason);
    if (status == STATUS_DEVICE && group == GROUP_PUBLISHED) {
        /* An index cut to 15 bits can make a circle; the engine says so instead of answering. */
        c->unfinished++;
        return;
    }
    if (status) {
        fprintf(stderr, "truth: %s, %s rays, %s: %s\n", ground->spec, ground->rays,
                who->engine->name, reason.text);
        c->code = exit_worse(c->code, exit_of_status(status));
        return;
    }
    struct play_result *sum = &c->sum[group];
    c->refused += result.refused;
    sum->judged += result.judged;
    sum->hits += result.hits;
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        sum->verdict[v] += result.verdict[v];
    if (result.worst_over > sum->worst_over)
        sum->worst_over = result.worst_over;
}

static void play_all(struct truth_campaign *c, struct ground *ground)
{
    static const char *const pairs[][2] = {{"mt", "robust"}, {"woop", "watertight"}};
    static const char *const own[] = {"cpu", "vulkan"};
    size_t count = ground->count;
    for (size_t t = 0; t < ARRAY_COUNT(pairs); t++)
        for (size_t e = 0; e < ARRAY_COUNT(own); e++)
            for (size_t l = 0; layouts[l]; l++) {
                struct tally_contestant who = {.engine = engine_find(own[e]),
                                               .layout = layouts[l],
                                               .box = box_test_find(pairs[t][1]),
                                               .tri = tri_test_find(pairs[t][0])};
                ground->count = layouts[l]->faithful ? count / PUBLISHED_SHARE : count;
                if (ground->count > 0)
                    play_one(c, ground, &who, layouts[l]->faithful ? GROUP_PUBLISHED : (int)t);
                ground->count = count;
            }
    struct tally_contestant embree = {
        .engine = engine_find("embree_robust"), .box = box_tests[0], .tri = tri_test_find("mt")};
    play_one(c, ground, &embree, GROUP_EMBREE);
}

static enum status play_rays(struct truth_campaign *c, struct ground *ground,
                             const struct ray_set *set, size_t count, uint64_t seed,
                             struct reason *reason)
{
    ground->rays = set->name;
    ground->seed = seed;
    ground->count = count;
    enum status status = ray_set_make(set, &ground->scene, seed, count, ground->ray, reason);
    if (!status)
        status = oracle_closest(ground->oracle, ORACLE_TREE, ORACLE_CLOSED, ground->ray, count, 0,
                                ground->truth, NULL, reason);
    if (!status)
        play_all(c, ground);
    return status;
}

static enum status play_scene(struct truth_campaign *c, const char *spec, struct reason *reason)
{
    struct ground ground = {.spec = spec};
    enum status status = scene_open(spec, 1, &ground.scene, reason);
    if (!status)
        status = oracle_make(&ground.scene, &ground.oracle, reason);
    if (!status)
        status = stand_tree(&ground.scene, &ground.bvh, reason);
    ground.ray = alloc_zeroed(BATCH, sizeof *ground.ray);
    ground.truth = alloc_zeroed(BATCH, sizeof *ground.truth);
    ground.hit = alloc_zeroed(BATCH, sizeof *ground.hit);
    ground.judgement = alloc_zeroed(BATCH, sizeof *ground.judgement);
    if (!status && !(ground.ray && ground.truth && ground.hit && ground.judgement))
        status = fail(reason, STATUS_MEMORY, "no memory for %u rays", BATCH);
    for (size_t s = 0; s < ARRAY_COUNT(ray_names) && !status; s++) {
        size_t left = (size_t)c->options.rays / ARRAY_COUNT(ray_names);
        for (uint64_t part = 0; left > 0 && !status; part++) {
            size_t count = left < BATCH ? left : BATCH;
            status = play_rays(c, &ground, ray_set_find(ray_names[s]), count,
                               c->options.seed + 1000 * part + s, reason);
            left -= count;
        }
    }
    free(ground.ray);
    free(ground.truth);
    free(ground.hit);
    free(ground.judgement);
    oracle_free(ground.oracle);
    bvh_free(&ground.bvh);
    scene_free(&ground.scene);
    return status;
}

static void print_groups(const struct truth_campaign *c)
{
    printf("%-18s %11s %11s", "answers of", "judged", "hits");
    for (enum verdict v = VERDICT_TIE; v < VERDICT_COUNT; v++)
        printf(" %9.9s", v == VERDICT_OUT_OF_CONTRACT ? "no_contr." : verdict_name(v));
    printf(" %8s\n", "err/E");
    size_t judged = 0;
    for (int g = 0; g < GROUP_COUNT; g++) {
        const struct play_result *sum = &c->sum[g];
        printf("%-18s %11zu %11zu", group_names[g], sum->judged, sum->hits);
        for (enum verdict v = VERDICT_TIE; v < VERDICT_COUNT; v++)
            printf(" %9zu", sum->verdict[v]);
        printf(" %8.3g\n", sum->worst_over);
        judged += sum->judged;
    }
    printf("%-18s %11zu\n\n", "all", judged);
}

/* Prints the result; returns the exit code. */
static int print_result(const struct truth_campaign *c)
{
    size_t wrong = 0, opinion[GMP_OPINION_COUNT] = {0}, own = 0;
    print_groups(c);
    for (size_t i = 0; i < c->tally.count; i++) {
        const struct signature *s = &c->tally.signature[i];
        char name[160];
        signature_name(s, name, sizeof name);
        printf("%-68s %8zu wrong (confirmed %zu), smallest scene %u triangles\n", name, s->count,
               s->opinion[GMP_CONFIRMED], s->smallest.scene.tri_count);
        wrong += s->count;
        for (int k = 0; k < GMP_OPINION_COUNT; k++)
            opinion[k] += s->opinion[k];
        if (s->first.who.layout && !s->first.who.layout->faithful)
            own += s->count;
    }
    printf("%zu scenes (%zu left out), %zu combinations refused by a layout or skipped, %zu of "
           "published layouts not finished (stack)\n",
           c->scenes, c->left_out, c->refused, c->unfinished);
    printf("WRONG: %zu in %zu signatures; cpu and vulkan on f32 and rf16: %zu of %zu\n", wrong,
           c->tally.count, own, c->sum[GROUP_MT].judged + c->sum[GROUP_WOOP].judged);
    printf("decided again by rationals:");
    for (int k = 0; k < GMP_OPINION_COUNT; k++)
        printf(" %s %zu", gmp_opinion_name((enum gmp_opinion)k), opinion[k]);
    printf("; without a signature %zu\n", c->tally.beyond);
    for (size_t i = 0; i < c->tally.doubtful_count; i++)
        wrong_answer_print(&c->tally.doubtful[i], stdout);
    bool bad = opinion[GMP_OVERTURNED] > 0 || own > 0 || c->tally.beyond > 0;
    return exit_worse(c->code, bad ? EXIT_MISMATCH : EXIT_AGREE);
}

#define ROWS_OF struct truth_options

static const struct option_row rows[] = {
    {"rays", "N", "of each scene and contestant", OF_COUNT(rays, 100, 1u << 30), .value = "650000"},
    {"seed", "S", "of rays and scenes", OF_COUNT(seed, 0, UINT32_MAX), .value = "1"},
    {"out", "DIR", "where findings go", OF_FOLDER(out)},
    {0},
};

static const struct option_set set = {
    .command = "truth",
    .usage = "truth [OPTIONS]     (make truth ARGS='OPTIONS')",
    .about = "Judges rays and decides every WRONG again.",
    .group = {GROUP(rows), GROUP_AT(engine_rows, engines), GROUP_AT(outside_rows, engines)},
    .codes = "0 nothing overturned, 1 otherwise, 2 bad input, 3 an engine failed, 4 no memory",
    .example = "truth --rays 10000 --out build/truth",
};

int main(int argc, char **argv)
{
    static struct truth_campaign c;
    c.options = (struct truth_options){.engines = engine_options_default()};
    c.progress = progress_make("truth");
    int first, code = options_read(&set, &c.options, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first < argc)
        return usage_error("truth", "'%s' is not an option", argv[first]);
    c.pool.options = c.options.engines;
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct reason reason = {""};
        FILE *there = strchr(specs[i], '/') ? fopen(specs[i], "rb") : NULL;
        if (strchr(specs[i], '/') && !there) {
            printf("SKIP %s: not fetched (make scenes)\n", specs[i]);
            c.left_out++;
            continue;
        }
        if (there)
            fclose(there);
        enum status status = play_scene(&c, specs[i], &reason);
        progress_end(&c.progress);
        c.scenes++;
        if (status) {
            fprintf(stderr, "truth: %s: %s\n", specs[i], reason.text);
            c.code = exit_worse(c.code, exit_of_status(status));
        }
    }
    code = print_result(&c);
    struct reason reason = {""};
    if (c.options.out && tally_write(&c.tally, c.options.out, &reason)) {
        fprintf(stderr, "truth: %s\n", reason.text);
        code = exit_worse(code, EXIT_USAGE);
    }
    tally_free(&c.tally);
    pool_free(&c.pool);
    return code;
}
