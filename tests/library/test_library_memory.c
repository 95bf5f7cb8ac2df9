/* Without memory every function of the library returns RAYDIFF_ERROR_MEMORY and leaves nothing. */
#include "tests/support/allocations.h"

#include "ref/library/raydiff.h"
#include "scenes/rays/rays.h"

#include <stdarg.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/library/library_fixture.h"

#define RAYS 64

static float rays[8 * RAYS];
static struct raydiff_answer answers[RAYS];

static int fails(void *user, const struct raydiff_case *what)
{
    (void)user;
    return what->triangle_count > 2;
}

typedef enum raydiff_error library_call(const struct library_stand *stand, struct raydiff_why *why);

static enum raydiff_error make(const struct library_stand *stand, struct raydiff_why *why)
{
    struct raydiff_oracle *oracle;
    enum raydiff_error error =
        raydiff_oracle_make(stand->scene.vertex, stand->scene.vertex_count, stand->scene.index,
                            stand->scene.tri_count, &oracle, why);
    assert_int_equal(oracle == NULL, error != RAYDIFF_ERROR_NONE);
    raydiff_oracle_free(oracle);
    return error;
}

static enum raydiff_error exact(const struct library_stand *stand, struct raydiff_why *why)
{
    struct raydiff_nearest out[RAYS];
    return raydiff_exact(stand->oracle, rays, NULL, RAYS, 1, out, why);
}

static enum raydiff_error all(const struct library_stand *stand, struct raydiff_why *why)
{
    struct raydiff_crossing out[4];
    size_t found;
    enum raydiff_error error = RAYDIFF_ERROR_NONE;
    for (size_t i = 0; i < RAYS && !error; i++)
        error = raydiff_exact_all(stand->oracle, rays + 8 * i, 4, out, &found, why);
    return error;
}

static enum raydiff_error judge(const struct library_stand *stand, struct raydiff_why *why)
{
    const struct raydiff_judging how = {.demand_watertight = true};
    struct raydiff_judged out[RAYS];
    struct raydiff_counts counts;
    return raydiff_judge(stand->oracle, &how, rays, answers, RAYS, 1, out, &counts, why);
}

static enum raydiff_error world(const struct library_stand *stand, struct raydiff_why *why)
{
    const struct scene *scene = &stand->scene;
    const struct raydiff_mesh mesh = {scene->vertex, scene->index, scene->vertex_count,
                                      scene->tri_count};
    const struct raydiff_instance instance = {{2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 1};
    struct raydiff_nearest out[RAYS];
    struct raydiff_counts counts;
    static const uint32_t mask[RAYS];
    const struct raydiff_judging how = {.mask = mask};
    struct raydiff_oracle *oracle;
    enum raydiff_error error = raydiff_oracle_make_world(&mesh, 1, &instance, 1, &oracle, why);
    assert_int_equal(oracle == NULL, error != RAYDIFF_ERROR_NONE);
    if (!error)
        error = raydiff_exact(oracle, rays, mask, RAYS, 1, out, why);
    if (!error)
        error = raydiff_judge(oracle, &how, rays, answers, RAYS, 1, NULL, &counts, why);
    if (!error)
        error = raydiff_hard_rays(oracle, NULL, 1, RAYS, rays, why);
    raydiff_oracle_free(oracle);
    return error;
}

static enum raydiff_error hard(const struct library_stand *stand, struct raydiff_why *why)
{
    return raydiff_hard_rays(stand->oracle, NULL, 1, RAYS, rays, why);
}

static enum raydiff_error shrink(const struct library_stand *stand, struct raydiff_why *why)
{
    const struct raydiff_case what = {stand->scene.vertex, stand->scene.index,
                                      stand->scene.vertex_count, stand->scene.tri_count, rays};
    struct raydiff_small *small;
    enum raydiff_error error = raydiff_shrink(&what, fails, NULL, 50, &small, why);
    assert_int_equal(small == NULL, error != RAYDIFF_ERROR_NONE);
    raydiff_small_free(small);
    return error;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        library_call *call;
    } calls[] = {{"make", make}, {"exact", exact},   {"all", all},    {"judge", judge},
                 {"hard", hard}, {"shrink", shrink}, {"world", world}};
    struct library_stand stand = library_stand("sphere:n=3");
    for (size_t c = 0; c < sizeof calls / sizeof *calls; c++) {
        enum raydiff_error error = RAYDIFF_ERROR_MEMORY;
        bool failed = true;
        long n = 0;
        while (failed) {
            struct raydiff_why why = {"?"};
            assert_true(hard(&stand, NULL) == RAYDIFF_ERROR_NONE);
            const long before = atomic_load(&held);
            fail_after(n);
            error = calls[c].call(&stand, &why);
            failed = atomic_load(&has_failed);
            fail_after(-1);
            if (atomic_load(&held) != before)
                fail_msg("%s: allocation %ld fails: something is left", calls[c].name, n);
            /* The shrinker passes over a change that there is no memory for. */
            if (failed != (error == RAYDIFF_ERROR_MEMORY) && calls[c].call != shrink)
                fail_msg("%s: allocation %ld fails: error %d", calls[c].name, n, (int)error);
            assert_int_equal(why.line[0] != '\0', error != RAYDIFF_ERROR_NONE);
            n++;
        }
        assert_int_equal(error, RAYDIFF_ERROR_NONE);
        assert_true(n > 1); /* it allocates */
    }
    library_stand_free(&stand);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_allocation_may_fail)};
    for (size_t i = 0; i < RAYS; i++)
        answers[i].triangle = i % 3 ? RAYDIFF_NOTHING : (uint32_t)i;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
