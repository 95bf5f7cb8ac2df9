/* raydiff build --same: builders that depend on threads, or on how often they ran. */
#include "cmd/build/cmd_build_same.h"
#include "ref/base/command.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

static uint32_t built, threads[64];

static enum status note(const struct scene *scene, const struct build_options *options,
                        struct bvh *out, struct reason *reason)
{
    threads[built++ % 64] = options->threads;
    return builder_find("median")->build(scene, options, out, reason);
}

/* Planted: with several threads two items of a leaf are exchanged. */
static enum status racy(const struct scene *scene, const struct build_options *options,
                        struct bvh *out, struct reason *reason)
{
    enum status status = note(scene, options, out, reason);
    if (!status && options->threads > 8) {
        uint32_t kept = out->prim[0];
        out->prim[0] = out->prim[1];
        out->prim[1] = kept;
    }
    return status;
}

/* Planted: the last build has one box that is larger. */
static enum status tired(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    enum status status = note(scene, options, out, reason);
    if (!status && built == 9)
        out->node[out->node_count - 1].bounds.hi[0] += 1.0f;
    return status;
}

static void play(enum status (*build)(const struct scene *, const struct build_options *,
                                      struct bvh *, struct reason *),
                 struct same_row row[2])
{
    const struct builder builder = {.name = "it", .summary = "", .build = build};
    const struct builder *const builders_of[] = {&builder};
    const struct layout *const of[] = {layout_find("f32")};
    const struct same_job job = {
        .builder = builders_of, .builder_count = 1, .layout = of, .layout_count = 1, .rounds = 2};
    struct scene scene;
    struct reason reason = {""};
    built = 0;
    memset(row, 0, 2 * sizeof *row);
    assert_int_equal(scene_open("soup:n=50", 1, &scene, &reason), STATUS_OK);
    assert_int_equal(same_play(&job, &scene, row, &reason), STATUS_OK);
    scene_free(&scene);
}

static void every_number_of_threads_has_its_builds(void **state)
{
    (void)state;
    struct same_row row[2];
    uint32_t with[17] = {0};
    play(note, row);
    assert_int_equal(built, 9);
    for (uint32_t i = 0; i < built; i++)
        with[threads[i]]++;
    assert_int_equal(with[1], 3);
    assert_true(with[2] == 2 && with[8] == 2 && with[16] == 2);
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(row[i].builds, 8);
        assert_int_equal(row[i].differing, 0);
    }
}

static void a_tree_that_depends_on_threads_is_seen(void **state)
{
    (void)state;
    struct same_row row[2];
    play(racy, row);
    assert_int_equal(row[0].differing, 2);
    assert_string_equal(row[0].text, "with 16 threads: item 0");
    assert_int_equal(row[1].differing, 2); /* items are packed in that order */
}

static void one_build_that_differs_is_seen(void **state)
{
    (void)state;
    struct same_row row[2];
    play(tired, row);
    assert_int_equal(row[0].differing, 1);
    assert_non_null(strstr(row[0].text, "node "));
    assert_int_equal(row[1].differing, 1);
    assert_non_null(strstr(row[1].text, "word "));
}

/* Planted: with several threads leaves are smaller, so that there are more nodes. */
static enum status grown(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    struct build_options of = *options;
    of.leaf = options->threads > 2 ? 1 : of.leaf;
    return note(scene, &of, out, reason);
}

static void a_tree_of_another_size_is_seen(void **state)
{
    (void)state;
    struct same_row row[2];
    struct bvh one, other;
    struct scene scene;
    struct reason reason;
    char text[64];
    play(grown, row);
    assert_int_equal(row[0].differing, 4);
    assert_int_equal(row[1].differing, 4);
    assert_int_equal(scene_open("soup:n=50", 1, &scene, &reason), STATUS_OK);
    for (uint32_t many = 2; many <= 8; many += 6) {
        const struct build_options options = {.leaf = 4, .threads = many};
        assert_int_equal(grown(&scene, &options, many == 2 ? &one : &other, &reason), STATUS_OK);
    }
    snprintf(text, sizeof text, "with 8 threads: number of nodes %u", other.node_count);
    assert_string_equal(row[0].text, text);
    struct packed packed;
    assert_int_equal(packed_make(layout_find("f32"), &other, &scene, &packed, &reason), STATUS_OK);
    snprintf(text, sizeof text, "with 8 threads: number of words %zu", (size_t)packed.word_count);
    assert_string_equal(row[1].text, text);
    assert_true(one.node_count < other.node_count);
    packed_free(&packed);
    bvh_free(&one);
    bvh_free(&other);
    scene_free(&scene);
}

/* Any row that differs and any WRONG answer counts, whichever stands where; other bits of others do
 * not. */
static void what_differs_is_a_mismatch(void **state)
{
    (void)state;
    struct same_row row[3] = {{.builds = 8}, {.builds = 8}, {.builds = 8}};
    struct same_engine engine[2] = {{.builds = 8, .other = 5}, {.builds = 8}};
    assert_int_equal(same_code(row, 3, engine, 2), EXIT_AGREE);
    for (size_t i = 0; i < 3; i++) {
        row[i].differing = 1;
        assert_int_equal(same_code(row, 3, engine, 2), EXIT_MISMATCH);
        row[i].differing = 0;
    }
    for (size_t i = 0; i < 2; i++) {
        engine[i].wrong = 1;
        assert_int_equal(same_code(row, 3, engine, 2), EXIT_MISMATCH);
        engine[i].wrong = 0;
    }
}

/* Each library that builds trees of its own has all its builds, and traces all rays in each. */
static void every_library_has_its_builds(void **state)
{
    (void)state;
    const struct same_job job = {.rounds = 2, .seed = 3};
    struct same_engine one[SAME_ENGINES_MOST];
    struct scene scene;
    struct reason reason;
    size_t count = 0, at = 0;
    assert_int_equal(scene_open("soup:n=50", 1, &scene, &reason), STATUS_OK);
    assert_int_equal(same_engines(&job, &scene, one, &count, &reason), STATUS_OK);
    for (size_t i = 0; engines[i]; i++) {
        if (!engines[i]->library || engines[i]->needs_packed)
            continue;
        assert_true(at < count && one[at].engine == engines[i]);
        assert_true(one[at].absent ? one[at].builds == 0 : one[at].builds == 8);
        assert_true(one[at].rays == one[0].rays && one[at].wrong == 0);
        at++;
    }
    assert_int_equal(at, count);
    scene_free(&scene);
}

/* Planted in what matches answer: how many answers of each build have other bits than in the first,
 * how many are WRONG, and after how many builds the engine is absent; or NULL, and they are run. */
static struct {
    const size_t (*of)[2];
    uint32_t asked, absent, threads[64];
} made_up;

void __real_match_run(struct match *match, const struct engine *engine, struct row *row);
void __wrap_match_run(struct match *match, const struct engine *engine, struct row *row);

void __wrap_match_run(struct match *match, const struct engine *engine, struct row *row)
{
    if (!made_up.of) {
        __real_match_run(match, engine, row);
        return;
    }
    const size_t *is = made_up.of[made_up.asked % (2 * SAME_THREADS)];
    made_up.threads[made_up.asked % 64] = match->pool->options.threads;
    made_up.asked++;
    *row = (struct row){.status = made_up.asked > made_up.absent ? ROW_SKIPPED : ROW_OK,
                        .rays = match->ray_count};
    row->count[VERDICT_WRONG] = is[1];
    memset(match->answer, 0, match->ray_count * sizeof *match->answer);
    for (size_t i = 0; i < is[0]; i++)
        match->answer[3 * i].u = 0.5f;
}

/* Each library has a build with each number of threads in each round; what is other and WRONG is
 * that of all builds. */
static void every_number_of_threads_asks_each_library(void **state)
{
    (void)state;
    static const size_t of[2 * SAME_THREADS][2] = {{0, 1}, {3, 0}, {0, 20}, {5, 0},
                                                   {0, 0}, {7, 4}, {1, 0},  {2, 300}};
    const struct same_job job = {.rounds = 2, .seed = 3};
    struct scene scene;
    struct reason reason;
    assert_int_equal(scene_open("soup:n=50", 1, &scene, &reason), STATUS_OK);
    for (uint32_t absent = 0; absent <= 64; absent = absent ? 64 + absent : 64) {
        struct same_engine one[SAME_ENGINES_MOST];
        size_t count;
        made_up.asked = 0;
        made_up.absent = absent;
        made_up.of = of;
        assert_int_equal(same_engines(&job, &scene, one, &count, &reason), STATUS_OK);
        made_up.of = NULL;
        assert_true(count > 0 && count < 8);
        assert_int_equal(made_up.asked, absent ? 8 * count : count);
        for (uint32_t i = 0; i < made_up.asked && absent; i++)
            assert_int_equal(made_up.threads[i], same_threads[i % SAME_THREADS]);
        for (size_t i = 0; i < count; i++) {
            assert_int_equal(one[i].absent, absent == 0);
            assert_int_equal(one[i].builds, absent ? 8 : 0);
            assert_int_equal(one[i].other, absent ? 3 + 5 + 7 + 1 + 2 : 0);
            assert_int_equal(one[i].wrong, absent ? 325 : 0);
        }
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_of_threads_has_its_builds),
        cmocka_unit_test(a_tree_that_depends_on_threads_is_seen),
        cmocka_unit_test(one_build_that_differs_is_seen),
        cmocka_unit_test(a_tree_of_another_size_is_seen),
        cmocka_unit_test(what_differs_is_a_mismatch),
        cmocka_unit_test(every_library_has_its_builds),
        cmocka_unit_test(every_number_of_threads_asks_each_library),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
