/* Memory that runs out while worlds are composed and rays start inside them: each allocation in
 * turn fails. It must be said in one line, with nothing kept. */
#include "tests/support/allocations.h"

#include "scenes/rays/rays_inside_world.h"
#include "scenes/worlds/composed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#define RAYS       12
#define TIMES_MOST 4000

typedef enum status failing_step(const struct world *world, struct reason *reason);

/* Fails each allocation until there is none to fail; returns how many there are. */
static long fail_each(failing_step *step, const struct world *world)
{
    for (long n = 0; n < TIMES_MOST; n++) {
        struct reason reason = {""};
        atomic_store(&held, 0);
        fail_after(n);
        enum status status = step(world, &reason);
        atomic_store(&until_failure, -1);
        if (held != 0)
            fail_msg("without allocation %ld: %ld are kept", n, (long)held);
        if (!has_failed) {
            if (status)
                fail_msg("%s", reason.text);
            return n;
        }
        if (status != STATUS_MEMORY || !strstr(reason.text, "memory"))
            fail_msg("without allocation %ld: status %d, %s", n, status, reason.text);
    }
    fail_msg("never ends");
    return 0;
}

static enum status do_compose(const struct world *world, struct reason *reason)
{
    const struct composition of = {{2, 3, 5, 2, 3, 10, 2}};
    struct world out;
    (void)world;
    enum status status = composed_make(&of, 1, &out, reason);
    if (status)
        assert_true(!out.mesh && !out.instance && !out.first);
    world_free(&out);
    return status;
}

static enum status do_aim(const struct world *world, struct reason *reason)
{
    struct ray ray[RAYS];
    struct ray_mode mode[RAYS];
    uint8_t aim[RAYS];
    struct world_inside inside;
    return world_rays_inside_make(world, 1, RAYS, ray, mode, aim, &inside, reason);
}

static void each_allocation_may_fail(void **state)
{
    (void)state;
    assert_true(fail_each(do_compose, NULL) > 8);
    static const char *const specs[] = {"wall:n=1", "room:n=1"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct world world;
        struct reason reason;
        assert_int_equal(world_open(specs[s], 1, &world, &reason), STATUS_OK);
        assert_true(fail_each(do_aim, &world) > 10);
        world_free(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_allocation_may_fail)};
    return cmocka_run_group_tests_name("worlds_memory", tests, NULL, NULL);
}
