/* The oracle's cost: of a ray-triangle pair in the double filter, vectorised and scalar, and of
 * whole answers. */
#include "cmd/bench/cmd_bench.h"

#include "ref/base/command.h"
#include "ref/oracle/filter.h"
#include "ref/oracle/internal.h"
#include "scenes/rays/rays.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <math.h>
#include <stdlib.h>

#define RAYS    10000 /* for whole answers */
#define FILTER  1000  /* rays for the filter on one core */
#define KERNELS 4
#define THREADS 2 /* for brute force */

static const char about[] =
    "every ray against every triangle. filter: the first look with the kernel that this "
    "machine gets, and the full double filter on what it leaves, on one core; scalar: "
    "the full filter on every pair, on one core; both in time of that core, so that "
    "other work on the machine counts little; undecided: pairs that need integers. Then "
    "the exact nearest hits of all rays: brute on two threads, and by the oracle's own "
    "tree on one.\n"
    "";

/* How many pairs the filter decides, by result. */
struct oracle_tally {
    uint64_t pairs, missed, inside, undecided;
};

static void filter_one(const struct scene *scene, const struct ray *ray, uint32_t prim,
                       struct oracle_tally *tally)
{
    float v[3][3];
    struct filter filter;
    int positive = 0, negative = 0;
    scene_tri(scene, prim, v);
    filter_edges(ray, v, &filter);
    for (int c = 0; c < 3; c++) {
        positive += filter_sign(filter.w[c], filter.w_err[c]) > 0;
        negative += filter_sign(filter.w[c], filter.w_err[c]) < 0;
    }
    if (positive && negative)
        tally->missed++;
    else if (positive == 3 || negative == 3)
        tally->inside++;
    else
        tally->undecided++;
}

static struct oracle_tally filter_scalar(const struct oracle *oracle, const struct ray *ray,
                                         size_t count)
{
    struct oracle_tally tally = {0};
    for (size_t i = 0; i < count; i++)
        for (uint32_t prim = 0; prim < oracle->scene->tri_count; prim++)
            filter_one(oracle->scene, &ray[i], prim, &tally);
    tally.pairs = (uint64_t)count * oracle->scene->tri_count;
    return tally;
}

static double largest_in(const struct box *box, const struct early_ray *ray)
{
    double largest = 0;
    for (int k = 0; k < 3; k++) {
        double below = ray->o[k] - (double)box->lo[k], above = (double)box->hi[k] - ray->o[k];
        largest = below > largest ? below : largest;
        largest = above > largest ? above : largest;
    }
    return largest;
}

static struct oracle_tally filter_vector(const struct oracle *oracle,
                                         const struct early_kernel *kernel, const struct ray *ray,
                                         size_t count)
{
    struct oracle_tally tally = {0};
    uint32_t tris = oracle->scene->tri_count;
    for (size_t i = 0; i < count; i++) {
        struct early_ray early = early_ray_make(&ray[i]);
        for (uint32_t first = 0; first < tris; first += EARLY_MOST) {
            uint32_t run = tris - first < EARLY_MOST ? tris - first : EARLY_MOST;
            uint64_t left = kernel->look(&oracle->soup, &early, first, run,
                                         largest_in(&oracle->run[first / EARLY_MOST], &early));
            tally.missed += run - (uint32_t)__builtin_popcountll(left);
            for (; left; left &= left - 1)
                filter_one(oracle->scene, &ray[i],
                           oracle->tree.order[first + (uint32_t)__builtin_ctzll(left)], &tally);
        }
    }
    tally.pairs = (uint64_t)count * tris;
    return tally;
}

/* Times of one scene, one value per round. */
struct times {
    double scalar[BENCH_ROUNDS], kernel[KERNELS][BENCH_ROUNDS], ratio[BENCH_ROUNDS];
    double brute[BENCH_ROUNDS], tree[BENCH_ROUNDS];
};

struct measured {
    const char *spec;
    struct oracle *oracle;
    struct ray *ray;
    struct oracle_answer *brute, *tree;
    size_t count, filtered; /* rays for answers, rays for the filter */
    struct oracle_tally scalar, vector;
};

static enum status closest(const struct measured *it, enum oracle_path path, unsigned threads,
                           struct oracle_answer *out, double *seconds, struct reason *reason)
{
    uint64_t start = time_ns();
    enum status status = oracle_closest(it->oracle, path, ORACLE_CLOSED, it->ray, it->count,
                                        threads, out, NULL, reason);
    *seconds = (double)(time_ns() - start) * 1e-9;
    return status;
}

static enum status one_round(struct measured *it, size_t round, struct times *times,
                             struct reason *reason)
{
    const struct oracle *oracle = it->oracle;
    uint64_t start = core_time_ns();
    it->scalar = filter_scalar(oracle, it->ray, it->filtered);
    double pairs = (double)it->scalar.pairs;
    times->scalar[round] = (double)(core_time_ns() - start) / pairs;
    for (int k = 0; k < KERNELS && early_kernels[k].name; k++) {
        if (!early_kernels[k].runs())
            continue;
        start = core_time_ns();
        struct oracle_tally tally = filter_vector(oracle, &early_kernels[k], it->ray, it->filtered);
        times->kernel[k][round] = (double)(core_time_ns() - start) / pairs;
        if (&early_kernels[k] == oracle->kernel) {
            it->vector = tally;
            times->ratio[round] = times->kernel[k][round] / times->scalar[round];
        }
    }
    enum status status =
        closest(it, ORACLE_BRUTE, THREADS, it->brute, &times->brute[round], reason);
    if (status)
        return status;
    return closest(it, ORACLE_TREE, 1, it->tree, &times->tree[round], reason);
}

static size_t disagreements(const struct measured *it)
{
    size_t count = 0;
    for (size_t i = 0; i < it->count; i++) {
        const struct oracle_answer *a = &it->brute[i], *b = &it->tree[i];
        count += a->prim != b->prim || a->tie_count != b->tie_count || a->t_lo != b->t_lo ||
                 a->t_hi != b->t_hi || a->t_next != b->t_next || a->class != b->class ||
                 a->flags != b->flags;
    }
    return count;
}

static void print_times(struct bench *bench, const struct measured *it, struct times *times)
{
    size_t rounds = (size_t)bench->rounds;
    struct spread scalar = spread_of(times->scalar, rounds), filter = {0};
    struct spread ratio = spread_of(times->ratio, rounds);
    struct spread brute = spread_of(times->brute, rounds), tree = spread_of(times->tree, rounds);
    double each[KERNELS] = {0};
    uint32_t tris = it->oracle->scene->tri_count;
    const struct screen *screen = &bench->screen_is;
    screen_record(screen, PAINT_PLAIN, "%s: %s, %s; the filter on %zu of them\n", it->spec,
                  COUNTED(tris, "triangle"), COUNTED(it->count, "ray"), it->filtered);
    printf("  %-9s %7.3f (%.3f-%.3f) ns per pair\n", "scalar", scalar.median, scalar.least,
           scalar.most);
    for (int k = 0; k < KERNELS && early_kernels[k].name; k++) {
        if (!early_kernels[k].runs())
            continue;
        struct spread spread = spread_of(times->kernel[k], rounds);
        bool chosen = &early_kernels[k] == it->oracle->kernel;
        each[k] = spread.median;
        filter = chosen ? spread : filter;
        printf("  %-9s %7.3f (%.3f-%.3f) ns per pair%s\n", early_kernels[k].name, spread.median,
               spread.least, spread.most, chosen ? ", chosen" : "");
    }
    printf("  chosen / scalar %.3f (%.3f-%.3f)\n", ratio.median, ratio.least, ratio.most);
    screen_text(screen, "  left to integers of %s: %llu, scalar %llu\n",
                COUNTED(it->vector.pairs, "pair"), (unsigned long long)it->vector.undecided,
                (unsigned long long)it->scalar.undecided);
    printf("  exact nearest hits: brute %.3f s (%.3f-%.3f) on %d threads,\n"
           "                      tree %.3f us per ray\n",
           brute.median, brute.least, brute.most, THREADS, tree.median * 1e6 / (double)it->count);
    json_t *row = json_record("scene=%s tris=%u rays=%zu pairs=%zu kernel=%s filter_ns=%g "
                              "scalar_ns=%g ratio=%g undecided=%zu",
                              it->spec, tris, it->count, it->vector.pairs, it->oracle->kernel->name,
                              filter.median, scalar.median, ratio.median, it->vector.undecided);
    for (int k = 0; k < KERNELS && early_kernels[k].name; k++)
        json_add(row, "%s_ns=%g", early_kernels[k].name,
                 early_kernels[k].runs() ? each[k] : (double)NAN);
    json_add(row, "brute_s=%g tree_us=%g", brute.median, tree.median * 1e6 / (double)it->count);
    bench_row(bench, &bench_oracle, row);
}

static enum status measure(struct bench *bench, struct measured *it, struct reason *reason)
{
    static struct times times;
    for (size_t round = 0; round < bench->rounds; round++) {
        progress_done(&bench->progress, round, bench->rounds, "these rounds");
        progress_step(&bench->progress, "%s, round %zu", it->spec, round);
        enum status status = one_round(it, round, &times, reason);
        if (status)
            return status;
    }
    progress_end(&bench->progress);
    print_times(bench, it, &times);
    size_t wrong = disagreements(it);
    if (wrong == 0 && it->vector.inside == it->scalar.inside)
        return STATUS_OK;
    screen_text(&bench->screen_is,
                "  %s differ between brute force and tree; the filters found %llu and "
                "%llu inside\n",
                COUNTED(wrong, "answer"), (unsigned long long)it->vector.inside,
                (unsigned long long)it->scalar.inside);
    bench_worse(bench, EXIT_MISMATCH);
    return STATUS_OK;
}

static enum status bench_scene(struct bench *bench, const char *spec, const struct scene *scene,
                               struct reason *reason)
{
    struct measured it = {.spec = spec, .count = bench_rays_count(bench, RAYS)};
    enum status status = STATUS_OK;
    it.filtered = it.count < FILTER ? it.count : FILTER;
    it.ray = alloc_zeroed(it.count, sizeof *it.ray);
    it.brute = alloc_zeroed(it.count, sizeof *it.brute);
    it.tree = alloc_zeroed(it.count, sizeof *it.tree);
    if (!it.ray || !it.brute || !it.tree)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", it.count);
    if (!status)
        status = ray_set_make(ray_set_find("random"), scene, bench->seed, it.count, it.ray, reason);
    if (!status)
        status = oracle_make(scene, &it.oracle, reason);
    if (!status)
        status = measure(bench, &it, reason);
    oracle_free(it.oracle);
    free(it.ray);
    free(it.brute);
    free(it.tree);
    return status;
}

const struct benchmark bench_oracle = {
    .name = "oracle",
    .shown = "brute force and tree have the same answers",
    .refuted = "brute force and tree have other answers",
    .summary = "the double filter per ray-triangle pair, exact answers per ray",
    .takes = "scene count rounds csv json seed",
    .about = about,
    .scenes = "soup:n=10000;sphere:n=35",
    .play = bench_scene,
    .titled = true,
    .triangles = true,
};
