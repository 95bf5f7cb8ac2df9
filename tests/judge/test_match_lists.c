/* Rows of all hits: honest engines are right, and a list spoilt in one place is found, counted and
 * shown. The engine that spoils is made up. */
#include "ref/match/match.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/made_up.h"

#include "ref/trace/all_hits.h"

#include <math.h>
#include <string.h>

/* What the made-up engine does to the list of one ray, which has room for a hit more. */
typedef void spoil_fn(struct hit *hit, uint32_t *count);

static struct {
    spoil_fn *spoil;
    const struct ray *ray; /* whose list is spoilt */
    bool once;             /* the first time only */
    unsigned spoilt;
} list_script;

static enum status spoilt_trace_all(void *self, const struct ray *ray, size_t ray_count,
                                    uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                    struct reason *reason)
{
    const struct match *match = script.match;
    (void)self, (void)reason;
    for (size_t i = 0; i < ray_count; i++) {
        struct hit *list = hit + i * capacity;
        if (trace_ray_all(&(struct job){.scene = match->scene,
                                        .packed = &match->packed,
                                        .box = match->options.box,
                                        .tri = match->options.tri,
                                        .query = QUERY_ALL},
                          &ray[i], capacity, list, &hit_count[i], NULL))
            return STATUS_DEVICE;
        if (!list_script.spoil || memcmp(&ray[i], list_script.ray, sizeof *ray) != 0 ||
            (list_script.once && list_script.spoilt > 0))
            continue;
        assert_true(hit_count[i] < capacity);
        all_hits_sort(list, hit_count[i]);
        list_script.spoil(list, &hit_count[i]);
        list_script.spoilt++;
    }
    return STATUS_OK;
}

static const struct engine spoiler = {
    .name = "spoiler",
    .needs_packed = true,
    .open = made_up_open,
    .prepare = made_up_prepare,
    .trace = made_up_trace,
    .trace_all = spoilt_trace_all,
    .model = made_up_model,
    .close = made_up_close,
};

/* The first ray through three triangles or more, of which no engine may lose one. */
static size_t a_long_list(const struct fixture *f)
{
    for (size_t i = 0; i < RAYS; i++) {
        struct oracle_crossing *list = NULL;
        size_t capacity = 0, count = 0;
        bool certain = ray_in_contract(&f->ray[i]);
        assert_int_equal(oracle_crossings(f->match.oracle, &f->ray[i], (double)INFINITY, &list,
                                          &capacity, &count, NULL),
                         STATUS_OK);
        for (size_t k = 0; k < count && certain; k++) {
            float v[3][3];
            scene_tri(&f->scene, list[k].prim, v);
            certain = twin_eval(TWIN_MT, ROUNDING_IEEE, &f->ray[i], v).certain;
        }
        free(list);
        if (certain && count >= 3 && count < 7)
            return i;
    }
    fail_msg("no long list");
    return 0;
}

static struct fixture *begin_lists(void)
{
    struct fixture *f = begin();
    match_set(&f->match, box_tests[0], QUERY_ALL);
    return f;
}

/* --- honest ---------------------------------------------------------------------------------- */

static void honest_lists_are_right(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=500", "sphere", "flake", "grid:height=0"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct fixture *f = play(specs[s], "median", 4);
        for (size_t t = 0; tri_tests[t]; t++)
            for (size_t e = 0; engines[e]; e++) {
                /* Of the two scenes that the others are played in, each engine takes one. */
                if (!tri_tests[t]->core && (s != (t + e) % 2 || engines[e]->own_tri))
                    continue;
                if (t > 0 && s > 0 && strcmp(engines[e]->name, "vulkan_brute") == 0)
                    continue; /* it would take half of the time */
                assert_int_equal(match_rebuild(&f->match, f->options.builder, &f->options.build,
                                               tri_tests[t], &f->reason),
                                 STATUS_OK);
                pack(f, t % 2 ? "rf16" : "f32");
                match_set(&f->match, box_tests[0], QUERY_ALL);
                run(f, engines[e]->name);
                if (f->row.status == ROW_SKIPPED)
                    continue;
                if (f->row.finding_count) {
                    char line[512];
                    const struct finding *found = &f->row.finding[0];
                    judge_line(&found->ray, &found->judgement, &found->got, line, sizeof line);
                    fail_msg("%s %s %s: %s %s", specs[s], tri_tests[t]->name, engines[e]->name,
                             wrong_name(found->judgement.wrong), line);
                }
                assert_agrees(f);
                assert_true(f->row.lists.triangles > f->row.hits);
                assert_true(f->row.worst_over <= 1.0);
                assert_int_equal(f->row.lists.closed, s == 1 || s == 2);
                assert_int_equal(f->row.lists.parity > f->row.rays / 2, f->row.lists.closed);
                assert_true(f->row.lists.parity_off <= f->row.lists.parity / 10);
            }
        done(f);
    }
}

/* At the vertices of a sphere both hit twice, but only mt passes through walls: told apart. */
static void double_hits_are_counted(void **state)
{
    (void)state;
    size_t off[2];
    for (int woop = 0; woop < 2; woop++) {
        struct fixture *f = prepare("sphere", "median", 4);
        assert_int_equal(ray_set_make(ray_set_find("vertices"), &f->scene, 3, RAYS, f->ray, NULL),
                         STATUS_OK);
        f->options.tri = tri_test_find(woop ? "woop" : "mt");
        start(f);
        pack(f, "f32");
        match_set(&f->match, box_tests[0], QUERY_ALL);
        run(f, "cpu");
        assert_int_equal(f->row.differences, 0);
        assert_true(f->row.lists.doubles > f->row.rays / 10);
        off[woop] = f->row.lists.parity_off;
        done(f);
    }
    assert_true(off[0] > 50);
    assert_int_equal(off[1], 0);
}

/* --- spoilt ---------------------------------------------------------------------------------- */

static void lose_the_last(struct hit *hit, uint32_t *count)
{
    (void)hit;
    --*count;
}

static void lose_the_first(struct hit *hit, uint32_t *count)
{
    memmove(hit, hit + 1, --*count * sizeof *hit);
}

static void repeat(struct hit *hit, uint32_t *count)
{
    hit[*count] = hit[1];
    ++*count;
}

static void make_one_up(struct hit *hit, uint32_t *count)
{
    hit[*count] = hit[0];
    hit[*count].prim = hit[0].prim ? hit[0].prim - 1 : 1;
    ++*count;
}

static void invent(struct hit *hit, uint32_t *count)
{
    hit[*count] = hit[0];
    hit[*count].prim = 1u << 30;
    ++*count;
}

static void move(struct hit *hit, uint32_t *count)
{
    hit[*count - 1].t *= 1.001f;
}

static void turn(struct hit *hit, uint32_t *count)
{
    (void)count;
    hit[0].u += 0.001f;
}

static void forget(struct hit *hit, uint32_t *count)
{
    (void)count;
    hit[0].v = NAN;
}

static void one_bit(struct hit *hit, uint32_t *count)
{
    (void)count;
    hit[1].t = float_from_bits(float_bits(hit[1].t) ^ 1);
}

static void each_spoilt_list_is_found(void **state)
{
    (void)state;
    static const struct {
        spoil_fn *spoil;
        enum wrong wrong; /* WRONG_NOT: bits alone */
    } spoils[] = {
        {lose_the_last, WRONG_MISSED}, {lose_the_first, WRONG_MISSED}, {repeat, WRONG_TWICE},
        {make_one_up, WRONG_PHANTOM},  {invent, WRONG_PHANTOM},        {move, WRONG_DISTANCE},
        {turn, WRONG_BARYCENTRIC},     {forget, WRONG_NOT_FINITE},     {one_bit, WRONG_NOT}};
    struct fixture *f = begin_lists();
    size_t at = a_long_list(f);
    for (size_t s = 0; s < ARRAY_COUNT(spoils); s++) {
        bool wrong = spoils[s].wrong != WRONG_NOT;
        list_script.spoil = spoils[s].spoil;
        list_script.ray = &f->ray[at];
        list_script.once = false;
        match_run(&f->match, &spoiler, &f->row);
        assert_int_equal(f->row.status, ROW_OK);
        assert_int_equal(f->row.count[VERDICT_WRONG], wrong);
        assert_int_equal(f->row.wrong[spoils[s].wrong], wrong ? 1 : RAYS);
        assert_int_equal(f->row.bit_differences, 1);
        assert_int_equal(f->row.differences, 1 + wrong);
        assert_int_equal(f->row.finding_count, 1 + wrong);
        assert_true(row_failed(&f->row));
        for (size_t i = 0; i < f->row.finding_count; i++) {
            const struct finding *found = &f->row.finding[i];
            assert_int_equal(found->ray_index, at);
            assert_int_equal(found->bits, i == 0);
            if (found->bits)
                assert_memory_not_equal(&found->got, &found->expected, sizeof found->got);
            else
                assert_int_equal(found->got.prim == ABI_NO_PRIM, spoils[s].wrong == WRONG_MISSED);
        }
    }
    list_script.spoil = NULL;
    match_run(&f->match, &spoiler, &f->row);
    assert_agrees(f);
    done(f);
}

static void a_mood_is_found(void **state)
{
    (void)state;
    struct fixture *f = begin_lists();
    list_script.spoil = one_bit;
    list_script.ray = &f->ray[a_long_list(f)];
    list_script.once = true;
    list_script.spoilt = 0;
    match_run(&f->match, &spoiler, &f->row);
    assert_int_equal(f->row.wrong[WRONG_NOT_REPEATABLE], 1);
    assert_true(row_failed(&f->row));
    list_script.spoil = NULL;
    done(f);
}

/* As published: counted, not judged. */
static void the_published_box_test_is_counted(void **state)
{
    (void)state;
    struct fixture *f = begin_lists();
    match_set(&f->match, box_test_find("rtrs"), QUERY_ALL);
    list_script.spoil = lose_the_last;
    list_script.ray = &f->ray[a_long_list(f)];
    list_script.once = false;
    match_run(&f->match, &spoiler, &f->row);
    assert_false(f->row.judged);
    assert_true(f->row.wrong[WRONG_MISSED] > 0);
    assert_int_equal(f->row.differences, f->row.bit_differences);
    list_script.spoil = NULL;
    done(f);
}

static void who_cannot_list_is_skipped(void **state)
{
    (void)state;
    struct fixture *f = begin_lists();
    match_run(&f->match, &made_up, &f->row);
    assert_int_equal(f->row.status, ROW_SKIPPED);
    assert_int_equal(f->row.cause, STATUS_UNSUPPORTED);
    assert_non_null(strstr(f->row.reason.text, "made_up cannot list all hits"));
    assert_int_equal(script.prepared, 0);
    done(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(honest_lists_are_right),
        cmocka_unit_test(double_hits_are_counted),
        cmocka_unit_test(each_spoilt_list_is_found),
        cmocka_unit_test(a_mood_is_found),
        cmocka_unit_test(the_published_box_test_is_counted),
        cmocka_unit_test(who_cannot_list_is_skipped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
