/* Laws of judging in ref/library/raydiff.h: the library and `raydiff judge` judge alike. What the
 * command does with the answers of a file, match_run of a recorded engine, is done here beside. */
#include "ref/base/float_mode.h"
#include "ref/library/raydiff.h"
#include "ref/match/match.h"
#include "ref/outside/pipe.h"
#include "ref/outside/recorded.h"

#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/support/matched.h"

/* A match, the same triangles in the library, and answers that are right or spoiled. */
struct library_both {
    struct fixture *f;
    struct raydiff_oracle *oracle;
    struct hit hit[RAYS];
    struct raydiff_answer answer[RAYS];
    struct raydiff_judged judged[RAYS];
    struct raydiff_counts counts;
};

static struct library_both *both_make(const char *spec, enum query query)
{
    struct library_both *b = calloc(1, sizeof *b);
    struct raydiff_why why;
    b->f = play(spec, "median", 4);
    match_set(&b->f->match, box_tests[0], query);
    run(b->f, "brute");
    memcpy(b->hit, b->f->match.answer, sizeof b->hit);
    const struct scene *scene = &b->f->scene;
    if (raydiff_oracle_make(scene->vertex, scene->vertex_count, scene->index, scene->tri_count,
                            &b->oracle, &why))
        fail_msg("%s", why.line);
    return b;
}

static void both_free(struct library_both *b)
{
    raydiff_oracle_free(b->oracle);
    done(b->f);
    free(b);
}

/* Spoils one answer in `every`, each kind of fault in turn. */
static void spoil(struct library_both *b, size_t every)
{
    const uint32_t triangles = b->f->scene.tri_count;
    for (size_t i = 0; i < RAYS; i += every) {
        struct hit *hit = &b->hit[i];
        switch (i / every % 7) {
        case 0:
            *hit = hit_none();
            break;
        case 1:
            hit->t *= 1.0f + 0x1p-18f;
            break;
        case 2:
            hit->prim = (uint32_t)i % triangles;
            break;
        case 3:
            hit->u += 0x1p-12f;
            break;
        case 4:
            hit->t = NAN;
            break;
        case 5:
            hit->t *= 1.0f + 0x1p-22f;
            break;
        default:
            hit->v -= 0x1p-21f;
            break;
        }
        if (hit->prim == ABI_NO_PRIM) /* as a file has it */
            *hit = hit_none();
    }
}

/* The answers of `hit`, with anything beside a miss. */
static void answer(struct library_both *b)
{
    for (size_t i = 0; i < RAYS; i++) {
        const struct hit *hit = &b->hit[i];
        b->answer[i] = hit->prim == ABI_NO_PRIM
                           ? (struct raydiff_answer){NAN, 7, 7, RAYDIFF_NOTHING}
                           : (struct raydiff_answer){hit->t, hit->u, hit->v, hit->prim};
    }
}

static void judge_both(struct library_both *b, const struct raydiff_judging *how, uint32_t threads)
{
    uint32_t formula = 0, rounding = 0;
    struct raydiff_why why;
    while (how->formula && strcmp(pipe_formula_name(formula), how->formula) != 0)
        formula++;
    while (how->rounding && strcmp(pipe_rounding_name(rounding), how->rounding) != 0)
        rounding++;
    struct recorded recorded = {.ray = b->f->ray,
                                .hit = b->hit,
                                .count = RAYS,
                                .formula = formula,
                                .rounding = rounding,
                                .flags = (how->open ? PIPE_FLAG_OPEN : 0) |
                                         (how->watertight ? PIPE_FLAG_WATERTIGHT : 0) |
                                         (how->unnamed ? PIPE_FLAG_UNNAMED : 0)};
    const struct engine *engine;
    b->f->match.options.demands = (struct match_demands){.displacement = how->displacement,
                                                         .watertight = how->demand_watertight};
    match_set(&b->f->match, box_tests[0], how->any ? QUERY_ANY : QUERY_CLOSEST);
    assert_int_equal(recorded_engine(&recorded, &engine, NULL), STATUS_OK);
    match_run(&b->f->match, engine, &b->f->row);
    answer(b);
    if (raydiff_judge(b->oracle, how, b->f->ray->org, b->answer, RAYS, threads, b->judged,
                      &b->counts, &why))
        fail_msg("%s", why.line);
}

/* The findings of the command are answers that the library refuses for the same reason. */
static void assert_same_findings(const struct library_both *b, const struct raydiff_judging *how)
{
    const struct row *row = &b->f->row;
    for (size_t k = 0; k < row->finding_count; k++) {
        const struct finding *found = &row->finding[k];
        const size_t i = found->ray_index;
        char text[RAYDIFF_REASON_BYTES], wanted[512], line[480];
        assert_int_equal(b->judged[i].verdict, RAYDIFF_VERDICT_WRONG);
        assert_int_equal(b->judged[i].fault, found->judgement.wrong);
        assert_int_equal(b->judged[i].expected, found->judgement.expected);
        assert_int_equal(b->judged[i].lost,
                         found->judgement.behind ? found->judgement.lost : RAYDIFF_NOTHING);
        assert_true(b->judged[i].over == found->judgement.over);
        assert_true(b->judged[i].displacement == found->judgement.displacement);
        assert_int_equal(
            raydiff_reason(b->oracle, how, b->f->ray[i].org, &b->answer[i], text, NULL),
            RAYDIFF_ERROR_NONE);
        judge_line(&found->ray, &found->judgement, &found->got, line, sizeof line);
        snprintf(wanted, sizeof wanted, "wrong %s %s", wrong_name(found->judgement.wrong), line);
        assert_string_equal(text, wanted);
    }
}

static void assert_same(const struct library_both *b)
{
    const struct row *row = &b->f->row;
    uint64_t verdicts_of[RAYDIFF_VERDICTS] = {0}, faults_of[RAYDIFF_FAULTS] = {0};
    assert_true(row->status == ROW_OK || row->status == ROW_VACUOUS);
    assert_int_equal(b->counts.answers, RAYS);
    assert_int_equal(b->counts.hits, row->hits);
    for (size_t i = 0; i < RAYS; i++) {
        verdicts_of[b->judged[i].verdict]++;
        faults_of[b->judged[i].fault]++;
        assert_int_equal(b->judged[i].fault != 0, b->judged[i].verdict == RAYDIFF_VERDICT_WRONG);
    }
    for (int v = 0; v < RAYDIFF_VERDICTS; v++) {
        assert_int_equal(b->counts.verdict[v], row->count[v]);
        assert_int_equal(b->counts.verdict[v], verdicts_of[v]);
    }
    for (int w = 1; w < RAYDIFF_FAULTS; w++) {
        assert_int_equal(b->counts.fault[w], row->wrong[w]);
        assert_int_equal(b->counts.fault[w], faults_of[w]);
    }
    assert_int_equal(b->counts.beside_edges, row->edges_beyond);
    assert_int_equal(b->counts.in_fans, row->fans_lost);
    assert_int_equal(b->counts.faults, row->differences);
    assert_true(b->counts.over == row->worst_over);
    assert_true(b->counts.displacement == row->displacement.most);
    assert_int_equal(b->counts.vacuous, row->status == ROW_VACUOUS);
}

static const struct raydiff_judging ways[] = {
    {.formula = NULL},
    {.formula = "unknown", .open = true, .demand_watertight = true},
    {.formula = "unknown", .displacement = 0.5f},
    {.formula = "mt"},
    {.formula = "mt", .rounding = "vulkan"},
    {.formula = "woop", .watertight = true},
    {.formula = "embree", .rounding = "embree", .open = true},
    {.formula = "embree_robust", .rounding = "embree"},
    {.formula = "pluecker", .rounding = "flushed"},
    {.formula = "baldwin_webber", .rounding = "vulkan_rte"},
    {.formula = "tri_accel"},
};

static void library_and_command_judge_alike(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=8", "soup:n=500"};
    size_t unlike = 0;
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++)
        for (int any = 0; any < 2; any++) {
            struct library_both *b = both_make(specs[s], any ? QUERY_ANY : QUERY_CLOSEST);
            uint64_t wrong = 0;
            spoil(b, 5);
            for (size_t w = 0; w < ARRAY_COUNT(ways); w++) {
                struct raydiff_judging how = ways[w];
                how.any = any;
                judge_both(b, &how, (uint32_t)w % 3);
                assert_same(b);
                assert_same_findings(b, &how);
                assert_true(b->counts.faults > 60 && !b->counts.vacuous);
                unlike += b->counts.verdict[RAYDIFF_VERDICT_WRONG] != wrong;
                wrong = b->counts.verdict[RAYDIFF_VERDICT_WRONG];
            }
            both_free(b);
        }
    assert_true(unlike > 20); /* what is stated of the formula matters */
}

static void unnamed_hits_are_judged_as_the_command_does(void **state)
{
    (void)state;
    struct library_both *b = both_make("sphere:n=8", QUERY_ANY);
    const struct raydiff_judging named = {.any = true}, unnamed = {.any = true, .unnamed = true};
    for (size_t i = 0; i < RAYS; i++)
        if (b->hit[i].prim != ABI_NO_PRIM)
            b->hit[i] = (struct hit){.t = 0, .prim = 0};
    judge_both(b, &unnamed, 0);
    assert_same(b);
    assert_int_equal(b->counts.faults, 0);
    judge_both(b, &named, 0);
    assert_same(b);
    assert_true(b->counts.faults > 500);
    both_free(b);
}

static void what_is_right_has_no_fault(void **state)
{
    (void)state;
    struct library_both *b = both_make("soup:n=500", QUERY_CLOSEST);
    judge_both(b, &(struct raydiff_judging){.formula = NULL}, 0);
    assert_same(b);
    assert_int_equal(b->counts.faults, 0);
    assert_true(b->counts.verdict[RAYDIFF_VERDICT_RIGHT] > RAYS / 2);
    assert_true(b->counts.displacement > 0 && b->counts.displacement < 32);
    for (size_t i = 0; i < RAYS; i++)
        b->hit[i] = hit_none();
    judge_both(b, &(struct raydiff_judging){.formula = "mt"}, 0);
    assert_same(b);
    assert_true(b->counts.fault[RAYDIFF_FAULT_MISSED] > 500);
    both_free(b);
}

static void few_hits_prove_nothing(void **state)
{
    (void)state;
    struct library_both *b = both_make("soup:n=500", QUERY_CLOSEST);
    for (size_t i = 0; i < RAYS; i++) {
        b->f->ray[i].org[0] = 100.0f + (float)i;
        b->f->ray[i].tmax = 0.5f;
        b->f->ray[i].tmin = 0.0f;
        memset(b->f->ray[i].dir, 0, sizeof b->f->ray[i].dir);
        b->f->ray[i].dir[0] = 1.0f;
        b->hit[i] = hit_none();
        b->f->match.truth[i] = (struct oracle_answer){.prim = ABI_NO_PRIM};
    }
    judge_both(b, &(struct raydiff_judging){.formula = "mt"}, 0);
    assert_same(b);
    assert_true(b->counts.vacuous);
    both_free(b);
}

/* A program of -ffast-math flushes subnormals; its modes are as before after the call. */
static void modes_of_the_thread_change_nothing(void **state)
{
    (void)state;
    struct library_both *b = both_make("sphere:n=8", QUERY_CLOSEST);
    spoil(b, 3);
    for (size_t w = 0; w < ARRAY_COUNT(ways); w++) {
        judge_both(b, &ways[w], 1);
        struct raydiff_judged *plain = malloc(sizeof b->judged);
        memcpy(plain, b->judged, sizeof b->judged);
        const unsigned long saved = float_mode();
        const unsigned long set = saved | FLOAT_FLUSH | FLOAT_UP;
        float_mode_set(set);
        enum raydiff_error error = raydiff_judge(b->oracle, &ways[w], b->f->ray->org, b->answer,
                                                 RAYS, 1, b->judged, NULL, NULL);
        const unsigned long after = float_mode();
        float_mode_set(saved);
        assert_int_equal(error, RAYDIFF_ERROR_NONE);
        assert_int_equal(after & FLOAT_MODES, set & FLOAT_MODES);
        assert_memory_equal(plain, b->judged, sizeof b->judged);
        free(plain);
    }
    both_free(b);
}

#define THREADS 4

/* A thread's share: the same oracle, and one of its own. */
struct library_share {
    const struct library_both *b;
    struct raydiff_judged judged[RAYS];
    bool same;
};

static void *judge_beside(void *user)
{
    struct library_share *share = user;
    const struct library_both *b = share->b;
    const struct scene *scene = &b->f->scene;
    share->same = true;
    for (int i = 0; i < 4 && share->same; i++) {
        struct raydiff_oracle *own = NULL;
        share->same =
            raydiff_oracle_make(scene->vertex, scene->vertex_count, scene->index, scene->tri_count,
                                &own, NULL) == RAYDIFF_ERROR_NONE &&
            raydiff_judge(i % 2 ? own : b->oracle, NULL, b->f->ray->org, b->answer, RAYS,
                          1 + (uint32_t)i % 2, share->judged, NULL, NULL) == RAYDIFF_ERROR_NONE &&
            memcmp(share->judged, b->judged, sizeof b->judged) == 0;
        raydiff_oracle_free(own);
    }
    return NULL;
}

static void threads_may_share_an_oracle(void **state)
{
    (void)state;
    struct library_both *b = both_make("sphere:n=8", QUERY_CLOSEST);
    struct library_share *share = calloc(THREADS, sizeof *share);
    pthread_t thread[THREADS];
    spoil(b, 3);
    judge_both(b, &(struct raydiff_judging){.formula = NULL}, 0);
    for (int i = 0; i < THREADS; i++) {
        share[i].b = b;
        assert_int_equal(pthread_create(&thread[i], NULL, judge_beside, &share[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_join(thread[i], NULL), 0);
        assert_true(share[i].same);
    }
    free(share);
    both_free(b);
}

static void what_cannot_be_judged_is_refused(void **state)
{
    (void)state;
    struct library_both *b = both_make("sphere:n=4", QUERY_CLOSEST);
    const float *ray = b->f->ray->org;
    static const struct {
        struct raydiff_judging how;
        const char *line;
    } wrong[] = {
        {{.formula = "mtt"}, "formula: there is no 'mtt'; did you mean mt?"},
        {{.formula = "mt", .rounding = "iee"}, "rounding: there is no 'iee'; did you mean ieee?"},
        {{.displacement = -1.0f}, "displacement: -1 is not 0 or more, and finite"},
        {{.displacement = INFINITY}, "displacement: inf is not 0 or more, and finite"},
        {{.formula = "mt", .displacement = 2.0f}, "displacement: the formula is known"},
    };
    struct raydiff_why why;
    for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
        b->judged[0].expected = b->judged[1].verdict = 5;
        b->counts.answers = 5;
        assert_int_equal(raydiff_judge(b->oracle, &wrong[i].how, ray, b->answer, 2, 0, b->judged,
                                       &b->counts, &why),
                         RAYDIFF_ERROR_INPUT);
        assert_string_equal(why.line, wrong[i].line);
        assert_int_equal(b->judged[0].expected + b->judged[1].verdict + b->counts.answers, 0);
    }
    const char *text = "text: is NULL";
    assert_int_equal(raydiff_reason(b->oracle, NULL, ray, b->answer, NULL, &why),
                     RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, text);
    assert_int_equal(raydiff_judge(b->oracle, NULL, NULL, b->answer, 1, 0, NULL, NULL, &why),
                     RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, "rays: is NULL");
    assert_int_equal(raydiff_judge(b->oracle, NULL, ray, NULL, 1, 0, NULL, NULL, &why),
                     RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, "answers: is NULL");
    assert_int_equal(raydiff_judge(b->oracle, NULL, NULL, NULL, 0, 0, NULL, &b->counts, &why),
                     RAYDIFF_ERROR_NONE);
    assert_true(b->counts.vacuous);
    both_free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(library_and_command_judge_alike),
        cmocka_unit_test(unnamed_hits_are_judged_as_the_command_does),
        cmocka_unit_test(what_is_right_has_no_fault),
        cmocka_unit_test(few_hits_prove_nothing),
        cmocka_unit_test(modes_of_the_thread_change_nothing),
        cmocka_unit_test(threads_may_share_an_oracle),
        cmocka_unit_test(what_cannot_be_judged_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
