/* A stage's trees, and errors on the way to a finding's smallest trial: each layout of a trial that
 * moves has the tree that its bytes were made of; what ends a play ends what plays. */
#include "fuzz/play/stage.h"
#include "fuzz/shrink/shrink.h"
#include "ref/trace/trace.h"

#include "tests/support/fuzz_trials.h"

static const char *const layout_names[] = {"f32", "rf16", "half4", "bvh4_u8_node"};
#define LAYOUTS 4u
#define BINARY  2u /* the first of them */

static struct fuzz_player *opened(const struct engine *engine, size_t count)
{
    const struct engine_options options = {.device = -1, .threads = 1};
    const struct layout *layout[LAYOUTS] = {NULL};
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason;
    for (size_t i = 0; i < count; i++)
        layout[i] = layout_find(layout_names[i]);
    if (fuzz_field_make(&engine, 1, layout, count, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

/* Packing it again gives the bytes. After a refit boxes and, in wide nodes, children may be others:
 * the leaves of a binary layout are still in their places. */
static void assert_is_of(const struct play_stage *stage, size_t i, const struct layout *layout)
{
    struct packed packed;
    struct reason reason;
    const struct packed *is = &stage->packed[i];
    bool refitted = stage->motion[i] == TRIAL_REFITTED;
    if (packed_make_stored(layout, stage->trial->store, stage_tree(stage, i), &stage->trial->scene,
                           &packed, &reason))
        fail_msg("%s", reason.text);
    if (!refitted || i < BINARY) {
        assert_int_equal(packed.word_count, is->word_count);
        assert_int_equal(packed.item_count, is->item_count);
        assert_memory_equal(packed.item, is->item, 4 * (size_t)packed.item_count);
    }
    if (!refitted)
        assert_memory_equal(packed.word, is->word, 4 * (size_t)packed.word_count);
    packed_free(&packed);
}

static void each_layout_has_the_tree_of_its_bytes(void **state)
{
    (void)state;
    struct fuzz_player *player = opened(engine_find("cpu"), LAYOUTS);
    size_t motions[TRIAL_REBUILT + 1] = {0}, refused = 0;
    for (uint64_t index = 0; index < 60; index++) {
        struct fuzz_trial trial;
        struct play_stage *stage = &player->stage[0];
        struct reason reason;
        trial_make(6, index, 8, 40, 4, &trial);
        trial.move = index % 3 ? 0.125f * (float)(index % 5) : 0;
        trial.move_seed = (uint32_t)index;
        if (index % 4 == 1) /* splits triangles, so that it is built again */
            trial.builder = builder_find("sbvh");
        for (uint32_t i = 0; i < 3 * trial.scene.vertex_count && index % 7 == 1; i++)
            trial.scene.vertex[i] *= 20000.0f; /* beyond float16, which some layouts refuse */
        if (stage_set(stage, player, &trial, NULL, &reason))
            fail_msg("%s", reason.text);
        for (size_t i = 0; i < player->layout_count; i++) {
            refused += !stage->has_packed[i];
            if (!stage->has_packed[i])
                continue;
            motions[stage->motion[i]]++;
            assert_is_of(stage, i, player->layout[i]);
        }
        stage_clear(stage);
        fuzz_trial_free(&trial);
    }
    for (size_t i = 0; i < ARRAY_COUNT(motions); i++)
        assert_true(motions[i] > 5);
    assert_true(refused > 5);
    fuzz_player_close(player);
}

/* --- an engine that misses everything, until its memory ends --- */

static size_t prepared, memory; /* how often; how often it may be */

static enum status short_open(const struct engine *engine, const struct engine_options *options,
                              void **self, struct reason *reason)
{
    (void)engine, (void)options, (void)reason;
    *self = &memory;
    return STATUS_OK;
}

static enum status short_prepare(void *self, const struct job *job, struct reason *reason)
{
    (void)self, (void)job;
    return prepared++ < memory ? STATUS_OK : (fail)(reason, STATUS_MEMORY, "no memory");
}

static enum status short_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                               struct trace_report *report, struct reason *reason)
{
    (void)self, (void)ray, (void)report, (void)reason;
    for (size_t i = 0; i < count; i++)
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
    return STATUS_OK;
}

static struct model short_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine, (void)self;
    return (struct model){.formula = twin_of_tri(tri->id), .rounding = ROUNDING_IEEE};
}

static void short_close(void *self)
{
    (void)self;
}

static const struct engine short_engine = {.name = "short",
                                           .open = short_open,
                                           .prepare = short_prepare,
                                           .trace = short_trace,
                                           .model = short_model,
                                           .close = short_close};

/* Shrinks the finding with memory for so many calls. */
static enum status shrink_with(struct fuzz_player *player, const struct finding_file *file,
                               size_t calls)
{
    const struct shrink_options options = {0};
    struct finding_file out;
    struct shrink_stats stats;
    struct reason reason = {""};
    prepared = 0;
    memory = calls;
    enum status status = fuzz_shrink_finding(player, file, &options, &out, &stats, &reason);
    if (!status)
        finding_file_free(&out);
    return status;
}

static void no_memory_is_not_taken_for_a_finding(void **state)
{
    (void)state;
    struct fuzz_player *player = opened(&short_engine, 0);
    struct finding_file file = {.has_signature = true};
    struct fuzz_result result;
    struct reason reason = {""};
    memory = SIZE_MAX;
    trial_make(2, 1, 16, 16, 20, &file.trial);
    assert_int_equal(fuzz_play(player, &file.trial, 1, &result, NULL, NULL, &reason), STATUS_OK);
    assert_true(result.finding_count > 0);
    struct fuzz_finding finding = result.finding[0];
    assert_int_equal(fuzz_explain(player, &file.trial, &finding, &reason), STATUS_OK);
    file.signature = finding.signature;
    assert_int_equal(shrink_with(player, &file, SIZE_MAX), STATUS_OK);
    const size_t all = prepared;
    assert_true(all > 20);
    for (size_t calls = 0; calls < all; calls += 1 + all / 60)
        assert_int_equal(shrink_with(player, &file, calls), STATUS_MEMORY);
    assert_int_equal(shrink_with(player, &file, all), STATUS_OK);
    finding_file_free(&file);
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_layout_has_the_tree_of_its_bytes),
        cmocka_unit_test(no_memory_is_not_taken_for_a_finding),
    };
    return cmocka_run_group_tests_name("fuzz_stage", tests, NULL, NULL) ? 1 : 0;
}
