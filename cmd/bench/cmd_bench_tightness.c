/* The bounds of t: the smallest rejected errors and the real ones, per formula and rounding. */
#include "cmd/bench/cmd_bench.h"
#include "bench/measure/tightness.h"

#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdlib.h>

#define PAIRS 100000
/* Draws per pair. In a scene of slivers most rays hit no inside. */
#define DRAWS_MOST 1000

static const char about[] =
    "rays at random points of random triangles, which they hit; everything in ulp of "
    "the exact t.\n"
    "  real      error of the formula with every operation rounded to nearest: median, "
    "the value that one in a thousand exceeds, largest\n"
    "  rejected  smallest error of t that the judge calls WRONG: median, the value that "
    "one in a thousand exceeds\n"
    "  medians   the median of rejected over that of real\n"
    "  times     the median of rejected over the 99.9th percentile of real\n"
    "  groups    the same for every 1000 pairs of like rejected error: median, and the "
    "worst group\n"
    "  alarms    answers that are right and that the judge calls WRONG: what the "
    "formula computed, and the exact t, u and v, each rounded once; exit code 1 if "
    "there is any\n"
    "  no bound  pairs of which any t is accepted\n"
    "";

/* Formulas. Each is measured with every rounding of its kind. */
static const struct tightness_formula {
    const char *name;
    enum twin_formula formula;
    bool embree;
} formulas[] = {
    {"mt", TWIN_MT, false},
    {"mt_rtrs", TWIN_MT_RTRS, false},
    {"woop", TWIN_WOOP, false},
    {"pluecker", TWIN_PLUECKER, false},
    {"baldwin_webber", TWIN_BALDWIN_WEBBER, false},
    {"tri_accel", TWIN_TRI_ACCEL, false},
    {"embree", TWIN_EMBREE, true},
    {"embree_robust", TWIN_EMBREE_ROBUST, true},
};

static const struct tightness_rounding {
    const char *name;
    struct rounding rounding;
    bool embree;
} roundings[] = {
    {"ieee", ROUNDING_IEEE, false},
    {"vulkan rte", ROUNDING_VULKAN_RTE, false},
    {"vulkan", ROUNDING_VULKAN, false},
    {"embree", ROUNDING_EMBREE, true},
};

/* A scene, and the pairs drawn from it. */
struct tightness_field {
    struct bench *bench;
    const char *spec;
    const struct scene *scene;
    struct oracle *oracle;
    struct tightness_pair *pair;
    struct tightness_one *one;
    size_t count;
    struct row_grid grid;
};

static const struct column columns[] = {
    {"verdict", .left = true},  {"formula", .left = true},
    {"rounding", .left = true}, {.title = "alarms"},
    {"no-bound", .rank = 1},    {.title = "real"},
    {"99.9-%", .rank = 2},      {"most", .rank = 3},
    {.title = "rejected"},      {"rejected-99.9-%", .rank = 5},
    {"medians", .rank = 4},     {"times", .rank = 6},
    {"groups", .rank = 7},      {"worst", .rank = 8},
};

static enum status draw_all(struct tightness_field *field, struct reason *reason)
{
    struct box bounds = scene_bounds(field->scene);
    struct rng rng = rng_make(field->bench->seed, 0);
    for (size_t i = 0; i < field->count; i++) {
        int draws = 0;
        while (!tightness_draw(field->oracle, field->scene, &bounds, &rng, &field->pair[i]))
            if (++draws == DRAWS_MOST)
                return fail(reason, STATUS_INPUT,
                            "%s: of %d rays at its triangles none hits an inside", field->spec,
                            DRAWS_MOST);
    }
    return STATUS_OK;
}

static void report(struct tightness_field *field, const struct tightness_formula *formula,
                   const struct tightness_rounding *rounding, const struct tightness *sum)
{
    if (!field->bench->screen_is.wide)
        grid_add(&field->grid, sum->alarms ? PAINT_BAD : PAINT_GOOD,
                 "%s\t%s\t%s\t%zu\t%zu\t%.2f\t%.2f\t%.3g\t%.3g\t%.3g\t%.1f\t%.1f\t%.1f\t%.1f",
                 sum->alarms ? "ALARM" : "agrees", formula->name, rounding->name, sum->alarms,
                 sum->unbounded, sum->real_p50, sum->real_p999, sum->real_most, sum->rejected_p50,
                 sum->rejected_p999, sum->medians, sum->times, sum->group_p50, sum->group_most);
    else
        printf("  %-14s %-10s %6.2f %7.2f %8.3g %8.3g %8.3g %7.1f %6.1f %6.1f %6.1f %6zu %8zu\n",
               formula->name, rounding->name, sum->real_p50, sum->real_p999, sum->real_most,
               sum->rejected_p50, sum->rejected_p999, sum->medians, sum->times, sum->group_p50,
               sum->group_most, sum->alarms, sum->unbounded);
    bench_row(field->bench, &bench_tightness,
              json_record("scene=%s formula=%s rounding=%s pairs=%zu real_p50=%g real_p999=%g "
                          "real_most=%g rejected_p50=%g rejected_p999=%g medians=%g times=%g "
                          "group_p50=%g group_most=%g alarms=%zu unbounded=%zu",
                          field->spec, formula->name, rounding->name, sum->count, sum->real_p50,
                          sum->real_p999, sum->real_most, sum->rejected_p50, sum->rejected_p999,
                          sum->medians, sum->times, sum->group_p50, sum->group_most, sum->alarms,
                          sum->unbounded));
}

static enum status measure(struct tightness_field *field, const struct tightness_formula *formula,
                           const struct tightness_rounding *rounding, struct reason *reason)
{
    const struct model model = {.formula = formula->formula, .rounding = rounding->rounding};
    struct judge *judge;
    enum status status = judge_make(field->oracle, &model, QUERY_ANY, &judge, reason);
    if (status)
        return status;
    progress_step(&field->bench->progress, "%s: %s, %s", field->spec, formula->name,
                  rounding->name);
#pragma omp parallel for schedule(dynamic, 256)
    for (long long i = 0; i < (long long)field->count; i++)
        field->one[i] = tightness_measure(judge, field->scene, &model, &field->pair[i]);
    judge_free(judge);
    progress_end(&field->bench->progress);
    struct tightness sum;
    status = tightness_sum(field->one, field->count, &sum, reason);
    if (status)
        return status;
    report(field, formula, rounding, &sum);
    if (sum.alarms > 0)
        bench_worse(field->bench, EXIT_MISMATCH);
    return STATUS_OK;
}

static enum status play(struct tightness_field *field, struct reason *reason)
{
    enum status status = oracle_make(field->scene, &field->oracle, reason);
    field->pair = alloc_zeroed(field->count, sizeof *field->pair);
    field->one = alloc_zeroed(field->count, sizeof *field->one);
    if (status == STATUS_OK && (!field->pair || !field->one))
        status = fail(reason, STATUS_MEMORY, "no memory for %zu pairs", field->count);
    if (status == STATUS_OK)
        status = draw_all(field, reason);
    if (status)
        return status;
    printf("%s: %s, %s\n", field->spec, COUNTED(field->scene->tri_count, "triangle"),
           COUNTED(field->count, "pair"));
    field->grid.column = columns;
    field->grid.column_count = ARRAY_COUNT(columns);
    if (field->bench->screen_is.wide)
        puts("  formula        rounding     real  99.9 %     most rejected   99.9 % medians  times "
             "groups  worst alarms no bound");
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
        for (size_t r = 0; r < ARRAY_COUNT(roundings) && status == STATUS_OK; r++)
            if (formulas[f].embree == roundings[r].embree)
                status = measure(field, &formulas[f], &roundings[r], reason);
    if (!field->bench->screen_is.wide)
        grid_print(&field->grid, &field->bench->screen_is);
    return status;
}

static enum status bench_scene(struct bench *bench, const char *spec, const struct scene *scene,
                               struct reason *reason)
{
    struct tightness_field field = {
        .bench = bench, .spec = spec, .scene = scene, .count = bench_rays_count(bench, PAIRS)};
    enum status status = play(&field, reason);
    oracle_free(field.oracle);
    free(field.pair);
    free(field.one);
    return status;
}

const struct benchmark bench_tightness = {
    .name = "tightness",
    .shown = "no correct answer is beyond its bound",
    .refuted = "a correct answer is beyond its bound",
    .summary = "the smallest rejected error of t over the real ones, per formula and rounding",
    .takes = "scene count csv json seed" BENCH_SCREEN,
    .about = about,
    .scenes = "soup:n=10000;sphere:n=35",
    .play = bench_scene,
    .titled = true,
    .triangles = true,
    .alone = true,
};
