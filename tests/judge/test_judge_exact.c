/* The answer that is exactly right, rounded to float32, is accepted from every formula with a bound
 * and from a black box. The judge's truth is the oracle's; the numbers of the
 * answer are those of rational arithmetic (GMP). */
#include "ref/twin/twin_replay.h"
#include "ref/twin/twin.h"
#include "tests/judge/degenerate.h"
#include "tests/exact/trials.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/honest_count.h"
#include "tests/judge/judge_fixture.h"

static const char *const specs[] = {"soup:n=60", "sphere:n=2",   "grid:n=5,height=0",
                                    "cornell",   "needles:n=60", "stack:n=12",
                                    "platonic",  "terrain:k=2"};

/* How many rays a scene, pairs a kind of trial and pairs a kind of degenerate triangle get. */
struct amount {
    size_t rays, pairs;
};

static struct amount amount(void)
{
    return getenv("RAYDIFF_SLOW") ? (struct amount){300000, 30000} : (struct amount){300, 30};
}

/* A judge for each kind of engine, all of the same scene. */
struct exact_bench {
    struct judge_fixture *fixture[SUBJECTS];
    struct honest_count honest[SUBJECTS];
    uint64_t hits[SUBJECTS];
    clock_t spent[SUBJECTS];
    struct gmp_pair pair;
};

/* The answer; false: this subject may not or need not give it. */
static bool exact_answer(const struct judge_fixture *c, const struct trials_trial *trial,
                         struct hit *out)
{
    const struct model *model = &c->subject->model;
    *out = a_miss();
    if (c->truth.prim == ABI_NO_PRIM)
        return true;
    const struct truth *truth = &trial->truth;
    *out = (struct hit){(float)truth->t.head, (float)truth->weight[1].head,
                        (float)truth->weight[2].head, c->truth.prim};
    if (!truth->point) /* the ray lies in the triangle's plane */
        return false;
    if (model->open && !(out->t > c->ray.tmin && out->t < c->ray.tmax))
        return false;
    if (model->formula != TWIN_MT_RTRS)
        return true;
    float v[3][3];
    memcpy(v, trial->v, sizeof v); /* below its own epsilon it answers nothing */
    return twin_eval(model->formula, model->rounding, &c->ray, v).possible;
}

static void must_be_believed(struct exact_bench *b, size_t s, const struct trials_trial *trial)
{
    struct judge_fixture *c = b->fixture[s];
    struct hit answer;
    char line[400];
    clock_t begun = clock();
    if (!exact_answer(c, trial, &answer))
        return;
    bool refused = verdict(c, answer) == VERDICT_WRONG;
    if (refused && b->honest[s].refused < HONEST_SHOWN) {
        judge_line(&c->ray, &c->judgement, &answer, line, sizeof line);
        print_message("%s: what is exactly right is WRONG (%s): %s\n", c->subject->name,
                      wrong_name(c->judgement.wrong), line);
    }
    b->hits[s] += answer.prim != ABI_NO_PRIM;
    honest_counted(&b->honest[s], refused);
    b->spent[s] += clock() - begun;
}

static void ask_all(struct exact_bench *b, const struct ray *ray)
{
    struct trials_trial trial = {.ray = *ray};
    struct judge_fixture *first = b->fixture[0];
    judge_fixture_ask(first, *ray);
    if (first->truth.prim != ABI_NO_PRIM) {
        scene_tri(&first->scene, first->truth.prim, trial.v);
        trial_truth(&b->pair, &trial);
    }
    for (size_t s = 0; s < SUBJECTS; s++) {
        b->fixture[s]->ray = *ray;
        b->fixture[s]->truth = first->truth;
        must_be_believed(b, s, &trial);
    }
}

static struct scene copy_of(const struct scene *scene)
{
    struct scene copy;
    assert_int_equal(scene_make(scene->vertex_count, scene->tri_count, &copy), STATUS_OK);
    memcpy(copy.vertex, scene->vertex, 3 * sizeof(float) * scene->vertex_count);
    memcpy(copy.index, scene->index, 3 * sizeof(uint32_t) * scene->tri_count);
    return copy;
}

/* Each subject gets a fixture of its own; the bench takes the scene. */
static void open_all(struct exact_bench *b, struct scene scene)
{
    for (size_t s = SUBJECTS; s-- > 0;) {
        b->fixture[s] = judge_fixture_of(s ? copy_of(&scene) : scene);
        judge_fixture_seat(b->fixture[s], &subjects[s], QUERY_CLOSEST);
    }
}

static void close_all(struct exact_bench *b)
{
    for (size_t s = 0; s < SUBJECTS; s++)
        judge_fixture_close(b->fixture[s]);
}

static void ask_of_scenes(struct exact_bench *b, size_t each)
{
    struct ray *ray = calloc(each, sizeof *ray);
    struct reason reason = {""};
    assert_non_null(ray);
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct scene scene;
        if (scene_open(specs[i], 7, &scene, &reason))
            fail_msg("%s", reason.text);
        open_all(b, scene);
        assert_int_equal(ray_set_make(ray_sets[0], &b->fixture[0]->scene, 40 + i, each, ray, NULL),
                         STATUS_OK);
        for (size_t k = 0; k < each; k++)
            if (ray_in_contract(&ray[k]))
                ask_all(b, &ray[k]);
        close_all(b);
    }
    free(ray);
}

static void ask_of_pair(struct exact_bench *b, const struct ray *ray, const float v[3][3])
{
    struct scene scene;
    for (int i = 0; i < 9; i++)
        if (!(fabsf(v[i / 3][i % 3]) <= 0x1p40f))
            return;
    if (!ray_in_contract(ray))
        return;
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    for (uint32_t c = 0; c < 3; c++)
        scene.index[c] = c;
    memcpy(scene.vertex, v, 9 * sizeof(float));
    open_all(b, scene);
    ask_all(b, ray);
    close_all(b);
}

static void ask_of_pairs(struct exact_bench *b, size_t each)
{
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        for (uint64_t i = 0; i < each; i++) {
            struct trials_trial trial;
            trial_make(kind, 1000000 + i, &b->pair, &trial);
            ask_of_pair(b, &trial.ray, (const float(*)[3])trial.v);
        }
    for (int kind = 0; kind < DEGENERATE_COUNT; kind++)
        for (uint64_t i = 0; i < each; i++) {
            struct rng rng = rng_make(1000000 + i, (uint64_t)kind);
            float v[3][3];
            degenerate_triangle((enum degenerate)kind, &rng, v);
            struct ray ray = degenerate_ray((enum degenerate)kind, &rng, v);
            ask_of_pair(b, &ray, (const float(*)[3])v);
        }
}

static void what_is_exactly_right_is_believed(void **state)
{
    (void)state;
    static struct exact_bench b;
    const struct amount how = amount();
    uint64_t refused = 0;
    exact_gmp_init(&b.pair);
    ask_of_scenes(&b, how.rays);
    ask_of_pairs(&b, how.pairs);
    exact_gmp_clear(&b.pair);
    for (size_t s = 0; s < SUBJECTS; s++) {
        print_message("%-26s %llu exactly right answers, %llu of them hits\n", subjects[s].name,
                      (unsigned long long)b.honest[s].evaluations, (unsigned long long)b.hits[s]);
        b.honest[s].begun = clock() - b.spent[s];
        refused += honest_ended(&b.honest[s], subjects[s].name);
        assert_true(b.hits[s] > b.honest[s].evaluations / 5);
    }
    assert_int_equal(refused, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_exactly_right_is_believed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
