/* What a stage tells of each layout's tree, refitted or built again, is what the last step of the
 * trial did to it, whatever the steps before did. */
#include "fuzz/gen/gen.h"
#include "fuzz/play/player.h"
#include "fuzz/play/stage.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

static struct fuzz_player *opened(void)
{
    static const char *const names[] = {"f32", "rf16", "obb8"}; /* the last is never refitted */
    const struct engine_options options = {.device = -1, .threads = 1};
    const struct engine *engine = engine_find("cpu");
    const struct layout *layout[ARRAY_COUNT(names)];
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason = {""};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++)
        layout[i] = layout_find(names[i]);
    if (fuzz_field_make(&engine, 1, layout, ARRAY_COUNT(names), &options, &field, &reason) ||
        fuzz_player_open(&field, &player, &reason))
        fail_msg("%s", reason.text);
    return player;
}

static void a_stage_tells_what_the_last_step_did(void **state)
{
    (void)state;
    struct fuzz_player *player = opened();
    struct play_stage *stage = &player->stage[0];
    uint32_t told[2][TRIAL_REBUILT + 1] = {{0}}, others[2] = {0};
    for (uint64_t index = 0; index < 240; index++) {
        const int worlds = index % 2;
        const struct gen_options options = {
            .triangles_least = 8, .triangles_most = 24, .rays = 2, .steps = true, .worlds = worlds};
        struct fuzz_trial trial;
        struct reason reason = {""};
        if (gen_trial(5, index, &options, &trial, &reason) ||
            stage_set(stage, player, &trial, NULL, &reason))
            fail_msg("%s", reason.text);
        const uint32_t last = trial.step_count;
        for (size_t i = 0; i < player->layout_count && last > 0; i++) {
            if (!stage->has_packed[i])
                continue;
            const bool first = trial.step[0].act == LIFE_REFIT;
            const bool rebuilds = trial.step[last - 1].act == LIFE_REBUILD;
            const enum life_fate fate =
                trial.world.is ? stage->world.lived[i][last].fate : stage->tree[i][last].fate;
            const bool refitted = fate == LIFE_REFITTED;
            assert_int_equal(stage->motion[i], refitted ? TRIAL_REFITTED : TRIAL_REBUILT);
            assert_true(!rebuilds || stage->motion[i] == TRIAL_REBUILT);
            told[trial.world.is][stage->motion[i]]++;
            others[trial.world.is] += first != refitted;
        }
        stage_clear(stage);
        fuzz_trial_free(&trial);
    }
    for (int worlds = 0; worlds < 2; worlds++)
        assert_true(told[worlds][TRIAL_REFITTED] > 20 && told[worlds][TRIAL_REBUILT] > 20 &&
                    others[worlds] > 20);
    fuzz_player_close(player);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stage_tells_what_the_last_step_did),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
