/* A match to be played on by tests. Include after cmocka.h. */
#ifndef TESTS_MATCHED_H
#define TESTS_MATCHED_H

#include "ref/match/match.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdlib.h>

#define RAYS 3000

/* A match on 500 random triangles, with leaves of 4 in f32 unless a test packs otherwise. */
struct fixture {
    struct scene scene;
    struct ray ray[RAYS];
    struct match_options options;
    struct pool pool;
    struct match match;
    struct row row;
    struct reason reason;
};

static inline void start(struct fixture *f)
{
    if (match_make(&f->scene, f->ray, RAYS, &f->options, &f->pool, &f->match, &f->reason))
        fail_msg("%s", f->reason.text);
}

static inline void pack(struct fixture *f, const char *layout)
{
    if (match_pack(&f->match, layout_find(layout), &f->reason))
        fail_msg("%s", f->reason.text);
}

static inline struct fixture *prepare(const char *spec, const char *builder, uint32_t leaf)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    if (scene_open(spec, 3, &f->scene, &f->reason))
        fail_msg("%s", f->reason.text);
    assert_int_equal(ray_set_make(ray_sets[0], &f->scene, 3, RAYS, f->ray, NULL), STATUS_OK);
    f->options = (struct match_options){.builder = builder_find(builder),
                                        .build = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT},
                                        .box = box_tests[0],
                                        .tri = tri_tests[0],
                                        .query = QUERY_CLOSEST,
                                        .repeats = 1,
                                        .brute_budget = UINT64_MAX};
    return f;
}

static inline struct fixture *play(const char *spec, const char *builder, uint32_t leaf)
{
    struct fixture *f = prepare(spec, builder, leaf);
    start(f);
    pack(f, "f32");
    return f;
}

static inline void run(struct fixture *f, const char *engine)
{
    match_run(&f->match, engine_find(engine), &f->row);
}

static inline void done(struct fixture *f)
{
    match_free(&f->match);
    pool_free(&f->pool);
    scene_free(&f->scene);
    free(f);
}

static inline size_t verdicts(const struct row *row)
{
    size_t sum = 0;
    for (int v = 0; v < VERDICT_COUNT; v++)
        sum += row->count[v];
    return sum;
}

static inline void assert_agrees(const struct fixture *f)
{
    const struct row *row = &f->row;
    if (row->status != ROW_OK || row->differences > 0)
        fail_msg("%s %s: %s, %zu differences: %s", row->engine->name,
                 row->layout ? row->layout->name : "-", row_status_name(row->status),
                 row->differences, row->reason.text);
    assert_false(row_failed(row));
    assert_int_equal(row->finding_count, 0);
    assert_int_equal(verdicts(row), row->rays);
    assert_int_equal(row->compared, row->rays);
    assert_true(row->hits > row->rays / 10 && row->hits < row->rays);
}

/* The row has wrong answers, and its findings are those of the match. `bits`: not cpu's bits, too.
 */
static inline void assert_differs(const struct fixture *f, bool bits)
{
    const struct row *row = &f->row;
    size_t wrong = 0;
    assert_int_equal(row->status, ROW_OK);
    assert_true(row->differences > 0);
    assert_true(row_failed(row));
    assert_int_equal(row->bit_differences > 0, bits);
    assert_int_equal(row->differences, row->bit_differences + row->count[VERDICT_WRONG]);
    for (int w = WRONG_MISSED; w < WRONG_COUNT; w++)
        wrong += row->wrong[w];
    assert_int_equal(wrong, row->count[VERDICT_WRONG]);
    assert_true(row->finding_count > 0 && row->finding_count <= 2 * FINDING_MOST);
    for (size_t i = 0; i < row->finding_count; i++) {
        const struct finding *found = &row->finding[i];
        size_t at = found->ray_index;
        assert_memory_equal(&found->ray, &f->ray[at], sizeof found->ray);
        assert_memory_equal(&found->truth, &f->match.truth[at], sizeof found->truth);
        assert_memory_equal(&found->got, &f->match.answer[at], sizeof found->got);
        if (found->bits) {
            assert_memory_equal(&found->expected, &f->match.against.hit[at],
                                sizeof found->expected);
            assert_memory_not_equal(&found->expected, &found->got, sizeof found->got);
        } else {
            assert_int_equal(found->judgement.verdict, VERDICT_WRONG);
            assert_int_not_equal(found->judgement.wrong, WRONG_NOT);
        }
    }
}

#endif
