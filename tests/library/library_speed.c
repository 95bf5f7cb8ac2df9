/* How much time the library's judging takes beside that of `raydiff judge`, on the same answers:
 *   library_speed LIBRARY [SCENE [RAYS [ROUNDS]]]      make library-speed
 * The two take turns on the same number of threads. Of the command an oracle, exact answers and a
 * match of recorded answers (ref/match/match.h) are timed, without brute force, text and tables; of
 * the library an oracle and raydiff_judge of the shared object. Prints medians and their ratio;
 * exit 1 if it is over 1.1. */
#include "ref/library/raydiff.h"
#include "ref/match/match.h"
#include "ref/outside/recorded.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS_MOST 99u
#define RATIO_MOST  1.1

typedef enum raydiff_error make_fn(const float *, uint32_t, const uint32_t *, uint32_t,
                                   struct raydiff_oracle **, struct raydiff_why *);
typedef void free_fn(struct raydiff_oracle *);
typedef enum raydiff_error judge_fn(const struct raydiff_oracle *, const struct raydiff_judging *,
                                    const float *, const struct raydiff_answer *, size_t, uint32_t,
                                    struct raydiff_judged *, struct raydiff_counts *,
                                    struct raydiff_why *);

struct library_race {
    struct scene scene;
    struct ray *ray;
    struct hit *hit;
    size_t count;
    struct raydiff_answer *answer;
    struct raydiff_judged *judged;
    struct oracle_answer *truth;
    struct pool pool;
    struct match match;
    make_fn *make;
    free_fn *end;
    judge_fn *judge;
};

static void must(bool failed, const char *line)
{
    if (!failed)
        return;
    fprintf(stderr, "library_speed: %s\n", line);
    exit(4);
}

static void *symbol(void *library, const char *name)
{
    void *found = dlsym(library, name);
    must(!found, name);
    return found;
}

static void open_library(struct library_race *race, const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    must(!library, path);
    *(void **)&race->make = symbol(library, "raydiff_oracle_make");
    *(void **)&race->end = symbol(library, "raydiff_oracle_free");
    *(void **)&race->judge = symbol(library, "raydiff_judge");
}

/* Rays, and the answers of engine fast to them. */
static void prepare(struct library_race *race, const char *spec, size_t count)
{
    struct reason reason = {""};
    const struct match_options options = {
        .builder = builders[0],
        .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
        .box = box_tests[0],
        .tri = tri_tests[0],
        .query = QUERY_CLOSEST,
        .repeats = 1};
    struct row row;
    race->count = count;
    must(scene_open(spec, 1, &race->scene, &reason), reason.text);
    must(ray_set_new(ray_sets[0], &race->scene, 1, count, &race->ray, &reason), reason.text);
    race->pool.options = (struct engine_options){.device = -1};
    must(match_make(&race->scene, race->ray, count, &options, &race->pool, &race->match, &reason),
         reason.text);
    must(match_pack(&race->match, layouts[0], &reason), reason.text);
    match_run(&race->match, engine_find("fast"), &row);
    must(row.status != ROW_OK, row.reason.text);
    race->hit = alloc_copy(race->match.answer, count, sizeof *race->hit);
    race->answer = alloc_zeroed(count, sizeof *race->answer);
    race->judged = alloc_zeroed(count, sizeof *race->judged);
    race->truth = alloc_zeroed(count, sizeof *race->truth);
    must(!race->hit || !race->answer || !race->judged || !race->truth, "no memory");
    for (size_t i = 0; i < count; i++)
        race->answer[i] = (struct raydiff_answer){race->hit[i].t, race->hit[i].u, race->hit[i].v,
                                                  race->hit[i].prim};
}

static uint64_t command_ns(struct library_race *race, const struct engine *engine, size_t *faults)
{
    struct reason reason = {""};
    struct oracle *oracle;
    struct row row;
    const uint64_t start = time_ns();
    must(oracle_make(&race->scene, &oracle, &reason), reason.text);
    must(oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, race->ray, race->count, 0, race->truth,
                        NULL, &reason),
         reason.text);
    match_run(&race->match, engine, &row);
    const uint64_t ns = time_ns() - start;
    must(row.status != ROW_OK, row.reason.text);
    *faults = row.differences;
    oracle_free(oracle);
    return ns;
}

static uint64_t library_ns(struct library_race *race, const char *formula, size_t *faults)
{
    const struct raydiff_judging how = {.formula = formula};
    const struct scene *scene = &race->scene;
    struct raydiff_oracle *oracle;
    struct raydiff_counts counts;
    struct raydiff_why why;
    const uint64_t start = time_ns();
    must(race->make(scene->vertex, scene->vertex_count, scene->index, scene->tri_count, &oracle,
                    &why),
         why.line);
    must(race->judge(oracle, &how, race->ray->org, race->answer, race->count, 0, race->judged,
                     &counts, &why),
         why.line);
    const uint64_t ns = time_ns() - start;
    *faults = counts.faults;
    race->end(oracle);
    return ns;
}

static double median(double *value, size_t count)
{
    sort_doubles(value, count);
    return value[count / 2];
}

/* Whether the library is within its bound for a formula. */
static bool within(struct library_race *race, uint32_t number, const char *formula, size_t rounds)
{
    double command[ROUNDS_MOST], library[ROUNDS_MOST], ratio[ROUNDS_MOST];
    const struct recorded recorded = {
        .ray = race->ray, .hit = race->hit, .count = race->count, .formula = number};
    const struct engine *engine;
    size_t theirs = 0, ours = 0;
    must(recorded_engine(&recorded, &engine, NULL), "no recorded engine");
    for (size_t i = 0; i < rounds; i++) {
        command[i] = (double)command_ns(race, engine, &theirs) * 1e-9;
        library[i] = (double)library_ns(race, formula, &ours) * 1e-9;
        ratio[i] = library[i] / command[i];
        must(ours != theirs, "the two do not judge alike");
    }
    const double middle = median(ratio, rounds);
    printf(
        "formula %-8s command %.3f s, library %.3f s, ratio %.3f (at most %.2f; of %zu rounds)\n",
        formula, median(command, rounds), median(library, rounds), middle, RATIO_MOST, rounds);
    return middle <= RATIO_MOST;
}

int main(int argc, char **argv)
{
    struct library_race race = {.count = 0};
    must(argc < 2, "LIBRARY [SCENE [RAYS [ROUNDS]]]");
    const char *spec = argc > 2 ? argv[2] : "flake:n=4";
    const size_t rays = argc > 3 ? strtoul(argv[3], NULL, 10) : 300000;
    const size_t given = argc > 4 ? strtoul(argv[4], NULL, 10) : 9;
    const size_t rounds = given < 1 ? 1 : given > ROUNDS_MOST ? ROUNDS_MOST : given;
    open_library(&race, argv[1]);
    prepare(&race, spec, rays);
    printf("%s: %u triangles, %zu answers of engine fast\n", spec, race.scene.tri_count, rays);
    bool good = within(&race, 0, "unknown", rounds);
    good = within(&race, 1, "mt", rounds) && good;
    match_free(&race.match);
    pool_free(&race.pool);
    return good ? 0 : 1;
}
