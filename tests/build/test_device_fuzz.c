/* A builder on a device that builds another tree than C: what the fuzz player makes of it. */
#include "fuzz/play/player.h"
#include "ref/layout.h"

#include "tests/support/fuzz_trials.h"

#include <stdio.h>

static enum status answer; /* of the comparison */
static uint32_t compared, built;

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    built++;
    return builder_find("lbvh63")->build(scene, options, out, reason);
}

static enum status compare(const struct scene *scene, struct reason *reason)
{
    compared += scene->tri_count > 0;
    strcpy(reason->text, answer ? "links 3: node 7, not leaf 2 (5 differ)" : "");
    return answer;
}

static const struct builder liar = {
    .name = "liar", .summary = "lies", .build = build, .compare = compare, .twin = "lbvh63"};

static void a_tree_that_differs_is_a_finding_of_every_layout(void **state)
{
    (void)state;
    static struct fuzz_result result;
    const struct engine *engine = engine_find("cpu");
    const struct layout *of[] = {layout_find("f32"), layout_find("cwbvh80")};
    const struct engine_options options = {.device = -1, .threads = 1};
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct fuzz_trial trial;
    struct reason reason = {""};
    if (fuzz_field_make(&engine, 1, of, 2, &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    trial_make(3, 1, 16, 16, 4, &trial);
    trial.builder = &liar;
    answer = STATUS_OK;
    assert_int_equal(fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason), STATUS_OK);
    assert_int_equal(result.finding_count, 0);
    assert_int_equal(compared, 1);
    assert_int_equal(built, 1);
    answer = STATUS_DEVICE;
    assert_int_equal(fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason), STATUS_OK);
    assert_int_equal(result.finding_count, 2);
    assert_int_equal(built, 1); /* the twin in C is traced instead */
    for (size_t i = 0; i < 2; i++) {
        struct fuzz_finding finding = result.finding[i];
        assert_int_equal(finding.signature.kind, FUZZ_KIND_TREE);
        assert_ptr_equal(finding.signature.layout, of[i]);
        assert_string_equal(finding.said, "links 3: node 7, not leaf 2 (5 differ)");
        assert_int_equal(fuzz_explain(player, &trial, &finding, &reason), STATUS_OK);
        assert_string_equal(cause_name(finding.signature.cause), "device_build");
    }
    answer = STATUS_UNSUPPORTED;
    assert_int_not_equal(fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason), STATUS_OK);
    fuzz_trial_free(&trial);
    fuzz_player_close(player);
}

static void names_are_added_once(void **state)
{
    (void)state;
    struct reason reason = {""};
    static struct builder more[BUILDERS_ADDED_MOST];
    static char name[BUILDERS_ADDED_MOST][16];
    size_t before = 0, after = 0;
    while (builders_all[before])
        before++;
    assert_int_equal(builder_add(builder_find("median"), &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "'median'"));
    for (size_t i = 0; i < BUILDERS_ADDED_MOST; i++) {
        more[i] = liar;
        snprintf(name[i], sizeof name[i], "liar%zu", i);
        more[i].name = name[i];
        assert_int_equal(builder_add(&more[i], &reason), STATUS_OK);
        assert_ptr_equal(builder_find(name[i]), &more[i]);
        assert_int_equal(builder_add(&more[i], &reason), STATUS_INPUT);
    }
    assert_int_equal(builder_add(&liar, &reason), STATUS_LIMIT);
    assert_null(builder_find("liar"));
    while (builders_all[after])
        after++;
    assert_int_equal(after, before + BUILDERS_ADDED_MOST);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_that_differs_is_a_finding_of_every_layout),
        cmocka_unit_test(names_are_added_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
