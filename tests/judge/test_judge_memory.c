/* Memory that runs out while answers are judged: each allocation in turn fails. It is an error
 * wherever it is, what could not be judged is not called right, and the same judge gives the same
 * judgement the next time. */
#include "tests/support/allocations.h"

#include "ref/judge/judge_all.h"
#include "ref/judge/judge_world.h"
#include "ref/judge/leaks.h"
#include "ref/base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"
#include "tests/judge/honest_world.h"

#define RAYS       24
#define TIMES_MOST 200

/* What is tried: returns the status, and writes its result where it is told to. */
struct trial_call {
    const struct judge_fixture *c;
    struct ray ray;
    struct oracle_answer truth;
    struct hit hit[3];
    size_t count;
    const struct topology *topology;
};

union result {
    struct judgement judgement;
    struct list_judgement list;
    struct list_mesh mesh;
    double need;
};

typedef enum status (*call)(const struct trial_call *t, union result *out);

static enum status one_answer(const struct trial_call *t, union result *out)
{
    enum status status = judge_answer(t->c->judge, &t->ray, &t->truth, t->hit, &out->judgement);
    if (status)
        assert_int_equal(out->judgement.verdict, VERDICT_OUT_OF_CONTRACT);
    return status;
}

static enum status many_answers(const struct trial_call *t, union result *out)
{
    struct judgement judged[3];
    struct judge_question question[3];
    for (int i = 0; i < 3; i++)
        question[i] = (struct judge_question){&t->ray, &t->truth, &t->hit[i]};
    enum status status = judge_answers(t->c->judge, question, 3, judged);
    out->judgement = judged[0];
    return status;
}

static enum status need_of(const struct trial_call *t, union result *out)
{
    return judge_need(t->c->judge, &t->ray, &t->truth, t->hit, &out->need);
}

static enum status one_list(const struct trial_call *t, union result *out)
{
    enum status status = judge_list(t->c->judge, &t->ray, t->hit, t->count, &out->list);
    if (status)
        assert_int_equal(out->list.judgement.verdict, VERDICT_OUT_OF_CONTRACT);
    return status;
}

static enum status mesh_of(const struct trial_call *t, union result *out)
{
    return judge_list_mesh(t->c->oracle, t->topology, true, &t->ray, t->hit, t->count, &out->mesh);
}

/* Returns how many allocations there were to fail. */
static long fail_each(call play, const struct trial_call *t)
{
    for (long n = 0; n < TIMES_MOST; n++) {
        union result out, again;
        memset(&out, 0, sizeof out);
        memset(&again, 0, sizeof again);
        fail_after(n);
        long before = held;
        enum status status = play(t, &out);
        atomic_store(&until_failure, -1);
        if (!has_failed) {
            assert_int_equal(status, STATUS_OK);
            before = held;
            assert_int_equal(play(t, &again), STATUS_OK);
            assert_int_equal(held, before);
            assert_memory_equal(&out, &again, sizeof out);
            return n;
        }
        assert_int_equal(status, STATUS_MEMORY);
        /* The topology of a mesh is kept, which was made before. */
        assert_true(held == before || t->c->subject->model.watertight || is_unknown(t->c->subject));
    }
    fail_msg("it never ends");
    return 0;
}

/* A ray from within the sphere towards a vertex, a point of an edge, or an inside. */
static struct ray aim(const struct judge_fixture *c, struct rng *rng, uint32_t i)
{
    static const float weight[3][3] = {{1, 0, 0}, {0.5f, 0.5f, 0}, {0.25f, 0.25f, 0.5f}};
    float v[3][3];
    struct ray ray = {.tmax = INFINITY};
    scene_tri(&c->scene, rng_below(rng, c->scene.tri_count), v);
    for (int k = 0; k < 3; k++) {
        ray.org[k] = rng_range(rng, -0.25f, 0.25f);
        for (int j = 0; j < 3; j++)
            ray.dir[k] += weight[i % 3][j] * v[j][k];
        ray.dir[k] -= ray.org[k];
    }
    return ray;
}

/* The nearest hit, a hit of another triangle, and none: as one list the first two, sorted. */
static void answers(struct judge_fixture *c, struct rng *rng, uint32_t i, struct trial_call *t)
{
    struct ray ray = aim(c, rng, i);
    judge_fixture_ask(c, ray);
    assert_int_not_equal(c->truth.prim, ABI_NO_PRIM);
    *t = (struct trial_call){.c = c, .ray = ray, .truth = c->truth, .count = 2};
    t->hit[i % 2] = right_answer(c, c->truth.prim);
    t->hit[1 - i % 2] = a_miss();
    t->hit[2] = right_answer(c, (c->truth.prim + 1) % c->scene.tri_count);
    if (i % 2)
        t->count = 0;
    else
        t->hit[1] = t->hit[2];
}

static void what_cannot_be_judged_is_an_error(void **state)
{
    (void)state;
    static const call calls[QUERY_COUNT][3] = {{one_answer, many_answers, need_of},
                                               {one_answer, many_answers, need_of},
                                               {one_list, mesh_of, NULL}};
    long failures[QUERY_COUNT][3] = {{0}};
    struct judge_fixture *c = judge_fixture_open("sphere:n=2", 1);
    struct topology topology;
    assert_int_equal(topology_make(&c->scene, &topology, NULL), STATUS_OK);
    struct rng rng = rng_make(1, 1);
    for (size_t s = 0; s < SUBJECTS; s++)
        for (enum query query = 0; query < QUERY_COUNT; query++)
            for (uint32_t i = 0; i < RAYS; i++)
                for (int k = 0; k < 3 && calls[query][k]; k++) {
                    struct trial_call t;
                    judge_fixture_seat(c, &subjects[s],
                                       query); /* anew, so that it keeps nothing yet */
                    answers(c, &rng, i, &t);
                    t.topology = &topology;
                    failures[query][k] += fail_each(calls[query][k], &t);
                }
    for (enum query query = 0; query < QUERY_COUNT; query++)
        for (int k = 0; k < 3 && calls[query][k]; k++)
            assert_true(failures[query][k] > 0);
    topology_free(&topology);
    judge_fixture_close(c);
}

static void a_judge_is_made_or_not(void **state)
{
    (void)state;
    for (int two_levels = 0; two_levels < 2; two_levels++)
        for (size_t s = 0; s < SUBJECTS; s++) {
            struct judge_fixture *c = judge_fixture_open("sphere:n=2", 1);
            struct judged_world w;
            judged_world_make(3, &w);
            const struct oracle *oracle = two_levels ? w.oracle : c->oracle;
            long n = 0;
            for (atomic_store(&has_failed, true); has_failed; n++) {
                struct reason reason = {""};
                struct judge *judge = c->judge;
                long before = held;
                fail_after(n);
                enum status status =
                    judge_make(oracle, &subjects[s].model, QUERY_CLOSEST, &judge, &reason);
                atomic_store(&until_failure, -1);
                assert_int_equal(status, has_failed ? STATUS_MEMORY : STATUS_OK);
                assert_int_equal(has_failed, judge == NULL);
                assert_int_equal(has_failed, strcmp(reason.text, "no memory for a judge") == 0);
                judge_free(judge);
                assert_int_equal(held, before);
            }
            assert_int_equal(n, two_levels ? 6 : 4);
            judged_world_free(&w);
            judge_fixture_close(c);
        }
}

/* Loses a hit of every second list, so that walls must be counted. */
static enum status lossy_all(void *self, const struct ray *ray, size_t count, uint32_t capacity,
                             struct hit *hit, uint32_t *hits, struct reason *reason)
{
    enum status status =
        engine_find("brute")->trace_all(self, ray, count, capacity, hit, hits, reason);
    for (size_t i = 0; i < count && !status; i += 2)
        hits[i] -= hits[i] > 0;
    return status;
}

/* Rays at vertices and edges from inside a sphere; a digest, so that what was counted is known. */
static void leaks_are_counted_or_not(void **state)
{
    (void)state;
    struct judge_fixture *c = judge_fixture_open("sphere:n=2", 1);
    struct topology topology;
    struct rng rng = rng_make(2, 1);
    struct ray ray[RAYS];
    uint8_t what[RAYS];
    assert_int_equal(topology_make(&c->scene, &topology, NULL), STATUS_OK);
    for (uint32_t i = 0; i < RAYS; i++) {
        ray[i] = aim(c, &rng, i);
        what[i] = i % 3 == 0 ? LEAK_VERTEX : LEAK_MIDPOINT;
    }
    const struct leak_rays rays = {&topology, c->oracle, ray, what, RAYS};
    struct engine lossy = *engine_find("brute");
    const struct engine *engine = &lossy;
    lossy.trace_all = lossy_all;
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct job job = {
        .scene = &c->scene, .tri = tri_test_find("mt_rtrs"), .query = QUERY_CLOSEST};
    long n = 0;
    for (atomic_store(&has_failed, true); has_failed; n++) {
        struct reason reason = {""};
        struct leaks leaks;
        uint64_t digest[RAYS];
        void *self;
        assert_true(n < TIMES_MOST);
        assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
        long before = held;
        fail_after(n);
        enum status status = leaks_count(&rays, engine, self, &job, &leaks, digest, &reason);
        atomic_store(&until_failure, -1);
        assert_int_equal(status, has_failed ? STATUS_MEMORY : STATUS_OK);
        assert_int_equal(has_failed, reason.text[0] != 0);
        assert_true(has_failed || leaks_total(&leaks).rays == RAYS);
        engine->close(self);
        assert_true(held <= before);
    }
    assert_true(n > 8); /* of hits, of lists, of crossings where a list is even */
    topology_free(&topology);
    judge_fixture_close(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_cannot_be_judged_is_an_error),
        cmocka_unit_test(a_judge_is_made_or_not),
        cmocka_unit_test(leaks_are_counted_or_not),
    };
    return cmocka_run_group_tests_name("judge_memory", tests, NULL, NULL) ? 1 : 0;
}
