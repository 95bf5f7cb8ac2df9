/* What raydiff leaks compares with engine cpu, bit for bit: an engine that answers as cpu does but
 * in one member of some answers has as many other bits, of scenes and of worlds. */
#include "cmd/common/cmd_tables.h"
#include "cmd/leaks/cmd_leaks.h"
#include "ref/base/base.h"
#include "ref/store.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>

#define RAYS 1500u

enum member { OF_NONE, OF_T, OF_U, OF_V, OF_PRIM, OF_TAG, MEMBERS };

static enum member changed; /* of each seventh answer that is a hit */
static size_t traced, lied;

static void lie(struct hit *hit, uint32_t *tag)
{
    uint32_t *const word[MEMBERS] = {[OF_T] = (uint32_t *)&hit->t,
                                     [OF_U] = (uint32_t *)&hit->u,
                                     [OF_V] = (uint32_t *)&hit->v,
                                     [OF_PRIM] = &hit->prim,
                                     [OF_TAG] = tag};
    if (traced++ % 7 != 3 || hit->prim == ABI_NO_PRIM || !word[changed])
        return;
    *word[changed] ^= 1;
    lied++;
}

static enum status trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    const enum status status = engine_find("cpu")->trace(self, ray, count, hit, report, reason);
    for (size_t i = 0; i < count && !status; i++)
        lie(&hit[i], NULL);
    return status;
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    const enum status status =
        engine_find("cpu")->worlds->trace_world(self, ray, mode, count, hit, tag, report, reason);
    for (size_t i = 0; i < count && !status; i++)
        lie(&hit[i], &tag[i]);
    return status;
}

static struct leaks_options options_of(const struct engine *engine)
{
    return (struct leaks_options){.layout = list_of_one(TABLE_LAYOUTS, layout_find("f32")),
                                  .store = list_of_one(TABLE_STORES, tri_stores[0]),
                                  .engine = list_of_one(TABLE_ENGINES, engine),
                                  .builder = list_of_one(TABLE_BUILDERS, builders[0]),
                                  .box = list_of_one(TABLE_BOX_TESTS, box_test_find("watertight")),
                                  .tri = list_of_one(TABLE_TRI_TESTS, tri_test_find("woop")),
                                  .build = build_options_default(),
                                  .count = RAYS,
                                  .seed = 3,
                                  .profile = leak_profiles[0],
                                  .engines = engine_options_default()};
}

static void each_other_answer_is_one(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=4", "placed-turned"};
    static struct world_tracer worlds;
    const struct engine *added;
    struct reason reason = {""};
    struct engine liar = *engine_find("cpu");
    worlds = *liar.worlds;
    worlds.trace_world = trace_world;
    liar.name = "liar";
    liar.reference = false;
    liar.trace = trace;
    liar.worlds = &worlds;
    assert_int_equal(engine_add(&liar, &added, &reason), STATUS_OK);
    const struct leaks_options options = options_of(added);
    for (size_t s = 0; s < 2; s++)
        for (int member = OF_NONE; member < MEMBERS; member++) {
            struct pool pool = {.options = options.engines};
            struct progress progress = progress_make("leaks");
            struct leak_scene result = {0};
            changed = (enum member)member;
            traced = lied = 0;
            const enum status status =
                leaks_play(&options, &pool, &progress, specs[s], &result, &reason);
            progress_end(&progress);
            if (status)
                fail_msg("%s", reason.text);
            assert_int_equal(result.row_count, 1);
            assert_int_equal(result.row[0].status, STATUS_OK);
            assert_true(result.row[0].compared);
            assert_int_equal(result.row[0].bit_differences, lied);
            assert_int_equal(lied > RAYS / 9, member != OF_NONE && (s || member != OF_TAG));
            free(result.row);
            pool_free(&pool);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_other_answer_is_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
