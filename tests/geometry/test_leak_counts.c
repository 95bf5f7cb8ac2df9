/* The leak counter against its definition in ref/judge/leaks.h, written anew: random
 * lists of hits of rays at corners, edges and insides, each count by value; and what a run of many
 * rays keeps of them. */
#include "ref/base/rng.h"
#include "tests/geometry/leak_definition.h"

#include <stdlib.h>
#include <string.h>

#define RAYS 2500u

/* --- an engine that answers as it is told ---------------------------------------------------- */

struct leak_told {
    const struct ray *first; /* the rays of the run, so that each is known by its place */
    struct hit *closest;
    struct hit (*list)[MOST];
    uint32_t *count;
    struct model model;
    enum query query[4]; /* of each prepare() */
    size_t prepared, calls, largest;
};

static enum status told_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct leak_told *told = self;
    (void)reason;
    assert_true(told->prepared < 4);
    told->query[told->prepared++] = job->query;
    return STATUS_OK;
}

static enum status told_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                              struct trace_report *report, struct reason *reason)
{
    struct leak_told *told = self;
    (void)reason;
    told->calls++;
    told->largest = count > told->largest ? count : told->largest;
    *report = (struct trace_report){.ns = 1};
    memcpy(hit, told->closest + (ray - told->first), count * sizeof *hit);
    return STATUS_OK;
}

static enum status told_trace_all(void *self, const struct ray *ray, size_t count,
                                  uint32_t capacity, struct hit *hit, uint32_t *hits,
                                  struct reason *reason)
{
    const struct leak_told *told = self;
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        size_t at = (size_t)(ray - told->first) + i;
        hits[i] = told->count[at];
        for (uint32_t k = 0; k < hits[i] && k < capacity; k++)
            hit[i * capacity + k] = told->list[at][k];
    }
    return STATUS_OK;
}

static struct model told_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)tri;
    return ((const struct leak_told *)self)->model;
}

static const struct engine told_engine = {.name = "told",
                                          .prepare = told_prepare,
                                          .trace = told_trace,
                                          .trace_all = told_trace_all,
                                          .model = told_model};

/* Counts one ray, and its digest: the words of its answers, mixed one after the other. */
static uint64_t mixed(uint64_t digest, const void *data, size_t words)
{
    for (size_t i = 0; i < words; i++) {
        uint32_t word;
        memcpy(&word, (const char *)data + 4 * i, 4);
        digest = (digest ^ word) * 18397679294719823053u;
        digest ^= digest >> 33;
    }
    return digest;
}

static uint64_t count_ray(const struct counted *c, const struct leak_told *told, size_t i,
                          struct leak_tally *tally, bool *is_double)
{
    uint32_t prim[MOST];
    size_t kept = 0, extra;
    uint64_t digest = mixed(0, &told->closest[i], 4);
    for (uint32_t k = 0; k < told->count[i]; k++) {
        uint32_t one = told->list[i][k].prim;
        bool again = one >= c->scene.tri_count;
        for (size_t j = 0; j < kept; j++)
            again = again || prim[j] == one;
        if (!again)
            prim[kept++] = one;
    }
    extra = kept - groups_of(c, told->first + i, prim, kept);
    *is_double = extra > 0;
    tally->rays++;
    tally->misses += told->closest[i].prim == ABI_NO_PRIM;
    tally->empty += kept == 0;
    tally->even += kept % 2 == 0;
    tally->repeated += kept < told->count[i];
    tally->doubles += extra > 0;
    if ((kept - extra) % 2 == 0)
        count_walls(c, &told->model, told->first + i, prim, kept, tally);
    return mixed(digest + told->count[i], told->list[i], 4 * (size_t)told->count[i]);
}

/* --- trials ---------------------------------------------------------------------------------- */

/* At a corner, a point of an edge, beside it, or at an inside of a triangle. */
static struct ray draw_ray(const struct scene *scene, struct rng *rng)
{
    struct ray ray = {.tmax = 1e30f};
    float v[3][3], weight[3] = {1, 0, 0};
    uint32_t what = rng_below(rng, 6), prim = rng_below(rng, scene->tri_count);
    scene_tri(scene, prim, v);
    if (what > 0)
        weight[1] = what == 1 ? 0.5f : rng_float(rng);
    if (what > 3)
        weight[2] = rng_float(rng) * (1 - weight[1]);
    weight[0] -= weight[1] + weight[2];
    float off = what == 3 ? rng_scaled(rng, -1, 1, -28, 8) : 0;
    float reach = rng_below(rng, 2) ? 0.0f : 2.0f; /* from inside, or from anywhere */
    for (int k = 0; k < 3; k++) {
        float target = off;
        for (int j = 0; j < 3; j++)
            target += weight[j] * v[j][k];
        ray.org[k] = rng_range(rng, -0.125f - reach, 0.125f + reach);
        if (what == 5) /* from the triangle's own plane, or from beside it */
            ray.org[k] = 2 * v[0][k] - v[1][k] + rng_range(rng, -1e-6f, 1e-6f);
        ray.dir[k] = target - ray.org[k];
    }
    return ray;
}

/* Most of what the ray meets, and anything else, a triangle that is none included. */
static uint32_t draw_list(const struct counted *c, const struct ray *ray, struct rng *rng,
                          struct hit list[MOST])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < c->scene.tri_count && count < MOST; i++) {
        struct oracle_pair pair;
        oracle_pair(c->oracle, ray, i, &pair);
        if (oracle_is_hit(&pair) && oracle_in_range(&pair, ORACLE_CLOSED) && rng_below(rng, 4))
            list[count++].prim = i;
    }
    if (rng_below(rng, 4) == 0 && count < MOST)
        list[count++].prim = rng_below(rng, c->scene.tri_count + 1);
    if (rng_below(rng, 8) == 0 && count > 0 && count < MOST)
        list[count].prim = list[0].prim, count++;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t other = rng_below(rng, count), prim = list[i].prim;
        list[i].prim = list[other].prim;
        list[other].prim = prim;
        list[i].t = rng_float(rng);
        list[i].u = rng_float(rng);
        list[i].v = rng_float(rng);
    }
    return count;
}

static void check_run(const struct counted *c, const struct model *model, struct rng *rng,
                      size_t run, struct leak_tally *sum)
{
    static struct ray ray[RAYS];
    static struct hit closest[RAYS], list[RAYS][MOST];
    static uint32_t count[RAYS];
    static uint8_t aim[RAYS];
    static uint64_t digest[RAYS];
    struct leak_told told = {ray, closest, list, count, *model, {QUERY_ANY}, 0, 0, 0};
    const struct leak_rays rays = {&c->topology, c->oracle, ray, aim, run};
    const struct job job = {.scene = &c->scene, .query = QUERY_ANY};
    struct leak_tally tally[LEAK_AIMS] = {{0}};
    uint64_t expected[RAYS];
    struct reason reason = {""};
    struct leaks leaks;
    size_t misses = 0, doubles = 0;
    for (size_t i = 0; i < run; i++) {
        ray[i] = draw_ray(&c->scene, rng);
        aim[i] = (uint8_t)rng_below(rng, LEAK_AIMS);
        count[i] = draw_list(c, &ray[i], rng, list[i]);
        closest[i] =
            (struct hit){.t = rng_float(rng), .prim = rng_below(rng, 300) ? 0 : ABI_NO_PRIM};
        bool is_double;
        struct leak_told before = told; /* lists in the order that they are answered in */
        expected[i] = count_ray(c, &before, i, &tally[aim[i]], &is_double);
        misses += closest[i].prim == ABI_NO_PRIM;
        doubles += is_double;
    }
    if (leaks_count(&rays, &told_engine, &told, &job, &leaks, digest, &reason))
        fail_msg("%s", reason.text);
    assert_true(leaks.lists && told.prepared == 2);
    assert_true(told.query[0] == QUERY_CLOSEST && told.query[1] == QUERY_ALL);
    assert_memory_equal(leaks.tally, tally, sizeof tally);
    assert_memory_equal(digest, expected, run * sizeof *digest);
    size_t kept = misses + doubles;
    assert_int_equal(leaks.finding_count, kept < LEAK_FINDINGS ? kept : LEAK_FINDINGS);
    for (size_t n = 0; n < leaks.finding_count; n++) {
        const struct leak_finding *f = &leaks.finding[n];
        assert_int_equal(f->is_double, n >= misses);
        assert_int_equal(f->aim, aim[f->ray_index]);
        assert_memory_equal(&f->ray, &ray[f->ray_index], sizeof f->ray);
        if (f->is_double)
            assert_true(excludes(c, &f->ray, f->prim[0], f->prim[1]));
        else
            assert_true(f->prim[0] == ABI_NO_PRIM && f->prim[1] == ABI_NO_PRIM &&
                        closest[f->ray_index].prim == ABI_NO_PRIM);
    }
    struct leak_tally total = leaks_total(&leaks);
    const size_t *from = (const size_t *)&total;
    for (size_t i = 0; i < sizeof total / sizeof *from; i++)
        ((size_t *)sum)[i] += from[i];
}

static void each_count_is_as_defined(void **state)
{
    (void)state;
    static const char *const specs[] = {"platonic", "sphere:n=3", "sphere:n=2", "platonic"};
    static const struct model models[] = {{.formula = TWIN_UNKNOWN},
                                          {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}},
                                          {.formula = TWIN_WOOP, .rounding = {2, 2, 5, 0x1p-126}}};
    struct rng rng = rng_make(3, 0);
    struct leak_tally sum[ARRAY_COUNT(models)] = {{0}};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct counted c;
        counted_make(specs[s], s < ARRAY_COUNT(specs) - 1 ? 0 : 16, &c);
        for (size_t m = 0; m < ARRAY_COUNT(models); m++) {
            check_run(&c, &models[m], &rng, RAYS, &sum[m]);
            for (int n = 0; n < 100; n++) /* a list that is the only one of its run */
                check_run(&c, &models[m], &rng, 1, &sum[m]);
        }
        counted_free(&c);
    }
    for (size_t m = 0; m < ARRAY_COUNT(models); m++)
        assert_true(sum[m].doubles > 100 && sum[m].lost > 100 && sum[m].phantoms > 100 &&
                    sum[m].repeated > 100 && sum[m].empty > 50 && sum[m].even > 300);
}

static void check_many(size_t count, size_t calls)
{
    const size_t missed[] = {0, 65535, 65536, 65537, count / 2 + 3, count - 1};
    struct engine silent = told_engine;
    struct ray *ray = calloc(count, sizeof *ray);
    struct hit *closest = calloc(count, sizeof *closest);
    uint8_t *aim = calloc(count, 1);
    uint64_t *digest = calloc(count, sizeof *digest);
    assert_true(ray && closest && aim && digest);
    for (size_t i = 0; i < count; i++) {
        ray[i].tmin = (float)i;
        closest[i].t = (float)i;
        aim[i] = (uint8_t)(i % 3);
    }
    for (size_t n = 0; n < ARRAY_COUNT(missed); n++)
        closest[missed[n]].prim = ABI_NO_PRIM;
    struct leak_told told = {.first = ray, .closest = closest};
    const struct leak_rays rays = {.ray = ray, .aim = aim, .ray_count = count};
    const struct job job = {.query = QUERY_ALL};
    struct reason reason = {""};
    struct leaks leaks;
    silent.trace_all = NULL;
    assert_int_equal(leaks_count(&rays, &silent, &told, &job, &leaks, digest, &reason), STATUS_OK);
    assert_true(told.calls == calls && told.largest == 65536 && leaks.ns == calls);
    assert_true(told.prepared == 1 && told.query[0] == QUERY_CLOSEST && !leaks.lists);
    for (size_t i = 0; i < count; i++)
        assert_true(digest[i] == mixed(0, &closest[i], 4));
    for (size_t a = 0; a < LEAK_AIMS; a++) {
        size_t misses = 0;
        for (size_t n = 0; n < ARRAY_COUNT(missed); n++)
            misses += missed[n] % 3 == a;
        const struct leak_tally want = {.rays = a < 3 ? (count + 2 - a) / 3 : 0, .misses = misses};
        assert_memory_equal(&leaks.tally[a], &want, sizeof want);
    }
    assert_int_equal(leaks.finding_count, LEAK_FINDINGS);
    for (size_t n = 0; n < LEAK_FINDINGS; n++)
        assert_true(leaks.finding[n].ray_index == missed[n] &&
                    leaks.finding[n].ray.tmin == ray[missed[n]].tmin);
    free(ray);
    free(closest);
    free(aim);
    free(digest);
}

/* Rays are traced in parts; of all of them the first misses are kept. */
static void a_run_of_many_rays_is_counted_to_its_last(void **state)
{
    (void)state;
    check_many(150001, 3);
    check_many(131072, 2);
}

static void names_are_those_of_the_header(void **state)
{
    (void)state;
    static const char *const names[] = {"vertex", "midpoint", "edge", "beside", "unknown"};
    for (int aim = 0; aim <= LEAK_AIMS; aim++)
        assert_string_equal(leak_aim_name((enum leak_aim)aim), names[aim]);
    for (size_t i = 0; leak_profiles[i]; i++)
        assert_ptr_equal(leak_profile_find(leak_profiles[i]->name), leak_profiles[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_count_is_as_defined),
        cmocka_unit_test(a_run_of_many_rays_is_counted_to_its_last),
        cmocka_unit_test(names_are_those_of_the_header),
    };
    return cmocka_run_group_tests_name("leak_counts", tests, NULL, NULL) ? 1 : 0;
}
