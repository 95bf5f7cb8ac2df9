/* Laws of playing trials: which rays count as judged, the tree that a trial with steps begins with,
 * and why a layout's program ends on a tree. */
#include "fuzz/play/trial_life.h"
#include "fuzz/play/trial_tree.h"
#include "ref/layout.h"

#include "tests/support/fuzz_trials.h"

#define RAYS 40u

static struct reason reason;

/* --- rays that are not finished --------------------------------------------------------------- */

static const struct engine *brute;
static uint32_t
    gap[2]; /* of so many rays an engine does not finish about one; 0: it finishes all */

static bool is_lost(const struct ray *ray, int which)
{
    const uint32_t bits = float_bits(ray->dir[0] * 3 + ray->org[1]);
    return gap[which] > 0 && bits != 0 && bits % gap[which] == 0;
}

static enum status trace_but(int which, void *self, const struct ray *ray, size_t count,
                             struct hit *hit, struct trace_report *report, struct reason *why)
{
    for (size_t i = 0; i < count; i++)
        if (is_lost(&ray[i], which))
            return (fail)(why, STATUS_DEVICE, "a ray was not finished");
    return brute->trace(self, ray, count, hit, report, why);
}

static enum status first_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                               struct trace_report *report, struct reason *why)
{
    return trace_but(0, self, ray, count, hit, report, why);
}

static enum status second_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                struct trace_report *report, struct reason *why)
{
    return trace_but(1, self, ray, count, hit, report, why);
}

static struct fuzz_player *player_of(const struct engine *const *engine, size_t count,
                                     const struct layout *layout)
{
    static const struct engine_options options = {.device = -1, .threads = 1};
    static struct fuzz_field field;
    struct fuzz_player *player;
    if (fuzz_field_make(engine, count, &layout, 1, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

/* A ray counts as judged if every contestant has answered it, whoever has not and in which order;
 * every answer has its verdict, and each that is not there is at fault. */
static void a_ray_is_judged_if_all_have_answered(void **state)
{
    (void)state;
    brute = engine_find("brute");
    struct engine lossy[2] = {*brute, *brute};
    for (int e = 0; e < 2; e++) {
        lossy[e].name = e ? "second" : "first";
        lossy[e].trace = e ? second_trace : first_trace;
        lossy[e].trace_tasks = NULL;
    }
    const struct engine *const fields[][3] = {{&lossy[0], brute, &lossy[1]},
                                              {brute, &lossy[1], &lossy[0]},
                                              {&lossy[1], &lossy[0], brute}};
    size_t all_lost = 0;
    for (uint32_t index = 0; index < 24; index++) {
        static struct fuzz_result result;
        struct fuzz_trial trial;
        size_t lost = 0, unfinished = 0, verdicts = 0;
        gap[0] = index % 4 == 0 ? 0 : 2 + index;
        gap[1] = index % 3 == 0 ? 0 : 30 - index;
        struct fuzz_player *player = player_of(fields[index % 3], 3, NULL);
        trial_make(4, index, 10, 30, RAYS, &trial);
        for (uint32_t i = 0; i < RAYS; i++) {
            bool first = is_lost(&trial.ray[i], 0), second = is_lost(&trial.ray[i], 1);
            lost += first || second;
            unfinished += (size_t)first + second;
        }
        if (fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason))
            fail_msg("%s", reason.text);
        for (int v = 0; v < VERDICT_COUNT; v++)
            verdicts += result.count[v];
        assert_int_equal(result.judged, RAYS - lost);
        assert_int_equal(verdicts, 3 * RAYS - unfinished);
        assert_int_equal(result.wrong, unfinished + result.count[VERDICT_WRONG]);
        all_lost += lost;
        fuzz_trial_free(&trial);
        fuzz_player_close(player);
    }
    assert_true(all_lost > 50);
}

/* --- trees ------------------------------------------------------------------------------------ */

static void assert_same_tree(const struct bvh *a, const struct bvh *b)
{
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->prim_count, b->prim_count);
    assert_memory_equal(a->prim, b->prim, a->prim_count * sizeof *a->prim);
    for (uint32_t i = 0; i < a->node_count; i++)
        assert_memory_equal(&a->node[i].bounds, &b->node[i].bounds, sizeof a->node[i].bounds);
}

/* However its vertices move, the tree of a trial with steps is built of where they are at first. */
static void a_trial_with_steps_begins_with_its_first_tree(void **state)
{
    (void)state;
    static const char *const steps[] = {"refit:jitter:2", "rebuild:mirror", "refit:one:3",
                                        "rebuild:jitter:2,refit:jitter:5", "refit:mirror"};
    size_t moved = 0;
    for (uint32_t i = 0; i < 5 * ARRAY_COUNT(steps); i++) {
        struct fuzz_trial trial;
        struct trial_life life;
        struct life_tree tree[LIFE_STEPS_MOST + 1];
        struct bvh bvh;
        trial_make(6, i, 10, 40, 1, &trial);
        if (steps_parse(steps[i % ARRAY_COUNT(steps)], trial.step, &trial.step_count, &reason) ||
            trial_life_make(&trial, &life, &reason) ||
            trial_life_trees(&trial, &life, layout_find("f32"), tree, &reason) ||
            fuzz_trial_build(&trial, &bvh, &reason))
            fail_msg("%s", reason.text);
        assert_same_tree(&bvh, &tree[0].bvh);
        /* Scenes before the first step are those of the trial without steps. */
        trial.step_count = 0;
        struct fuzz_trial still = trial;
        struct bvh at_rest;
        still.scene.vertex = life.scene[0].vertex;
        assert_int_equal(fuzz_trial_build(&still, &at_rest, &reason), STATUS_OK);
        assert_same_tree(&bvh, &at_rest);
        moved += memcmp(&tree[0].bvh.node[0].bounds, &tree[life.count].bvh.node[0].bounds,
                        sizeof(struct box)) != 0;
        bvh_free(&at_rest);
        bvh_free(&bvh);
        for (uint32_t k = 0; k <= life.count; k++)
            life_tree_free(&tree[k]);
        trial_life_free(&life);
        fuzz_trial_free(&trial);
    }
    assert_true(moved > 10);
}

/* A program that ends has the cause of its end, and one that goes on none. */
static void the_end_of_a_program_has_its_cause(void **state)
{
    (void)state;
    static const enum cause cause[] = {[LAYOUT_GOES_ON] = CAUSE_UNEXPLAINED,
                                       [LAYOUT_END_LEAF] = CAUSE_LEAF_OVERFULL,
                                       [LAYOUT_END_ITEM] = CAUSE_ITEM_AS_NODE};
    const struct engine *const cpu = engine_find("cpu");
    size_t seen[ARRAY_COUNT(cause)] = {0};
    for (size_t l = 0; layouts[l]; l++) {
        struct fuzz_player *player = player_of(&cpu, 1, layouts[l]);
        for (uint32_t i = 0; i < (layouts[l]->end ? 60 : 3); i++) {
            struct fuzz_finding finding = {
                .signature = {.layout = layouts[l], .kind = FUZZ_KIND_REFUSED}};
            struct fuzz_trial trial;
            struct bvh bvh;
            trial_make(8, i, 20, 60, 2, &trial);
            trial.build.leaf = 4 + i % 7;
            assert_int_equal(fuzz_trial_build(&trial, &bvh, &reason), STATUS_OK);
            enum layout_end end = layouts[l]->end ? layouts[l]->end(&bvh, &reason) : LAYOUT_GOES_ON;
            if (fuzz_explain(player, &trial, &finding, &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(finding.signature.cause, cause[end]);
            seen[end]++;
            bvh_free(&bvh);
            fuzz_trial_free(&trial);
        }
        fuzz_player_close(player);
    }
    for (size_t e = 0; e < ARRAY_COUNT(cause); e++)
        assert_true(seen[e] > 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_is_judged_if_all_have_answered),
        cmocka_unit_test(a_trial_with_steps_begins_with_its_first_tree),
        cmocka_unit_test(the_end_of_a_program_has_its_cause),
    };
    return cmocka_run_group_tests_name("play_laws", tests, NULL, NULL);
}
