/* Builders when memory runs out: an error and nothing kept, wherever that happens.
 * ref/build/room.c is left out of this program; what stands here takes its place. */
#include "ref/build/room.h"
#include "ref/build/links.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

static int left_to_make; /* before one fails; negative: none does */
static int held;

void *room_make(size_t count, size_t size)
{
    if (left_to_make == 0)
        return NULL;
    left_to_make -= left_to_make > 0;
    void *room = malloc(count * size + 1);
    held += room != NULL;
    return room;
}

void room_free(void *room)
{
    held -= room != NULL;
    free(room);
}

/* Fails the first, second, ... allocation until there is none to fail. Returns how many there were.
 */
static int fail_each(const struct builder *builder, const struct scene *scene, uint32_t passes,
                     bool rotates, float presplit)
{
    const struct build_options options = {
        .leaf = 2, .passes = passes, .rotates = rotates, .presplit = presplit};
    for (int n = 0; n < 200; n++) {
        struct bvh bvh = {.node_count = 7};
        struct reason reason = {""};
        left_to_make = n;
        held = 0;
        enum status status = bvh_build(builder, scene, &options, &bvh, &reason);
        if (!status) {
            left_to_make = -1;
            assert_int_equal(held, 2);
            assert_int_equal(bvh_check(&bvh, scene, NULL), STATUS_OK);
            bvh_free(&bvh);
            return n;
        }
        if (status != STATUS_MEMORY || !strstr(reason.text, "no memory to") || bvh.node ||
            bvh.prim || bvh.node_count)
            fail_msg("%s: without allocation %d: status %d, %s", builder->name, n, status,
                     reason.text);
        if (held != 0)
            fail_msg("%s: without allocation %d %d others are kept", builder->name, n, held);
    }
    fail_msg("%s: never ends", builder->name);
    return 0;
}

static void memory_that_ends_anywhere_is_an_error(void **state)
{
    (void)state;
    static const char *const name[] = {"sah_binned", "sah_sweep", "lbvh",    "ploc",
                                       "sbvh",       "trbvh",     "ploctree"};
    struct scene scene = built_soup(300, 1);
    for (size_t i = 0; i < ARRAY_COUNT(name); i++) {
        const struct builder *builder = builder_find(name[i]);
        int plain = fail_each(builder, &scene, 0, false, 0);
        int parts = builder_takes(builder, "presplit") ? 7 : 0;
        assert_true(plain >= 4);
        assert_true(fail_each(builder, &scene, 0, false, 0.5f) >= plain + parts);
        assert_true(fail_each(builder, &scene, 1, false, 0.5f) >= plain + parts + 8);
        assert_true(fail_each(builder, &scene, 1, false, 0) >= plain + 8);
        assert_true(fail_each(builder, &scene, 1, true, 0) >= plain + 8);
    }
    scene_free(&scene);
}

static void a_collapse_without_memory_leaves_the_tree(void **state)
{
    (void)state;
    struct scene scene = built_soup(100, 2);
    struct bvh bvh = trees_make(&scene, 1, TREES_LEFT);
    for (int n = 0; n < 2; n++) {
        left_to_make = n;
        assert_int_equal(tree_collapse(&bvh, 4), STATUS_MEMORY);
        assert_int_equal(bvh.node_count, 199);
        assert_int_equal(bvh_check(&bvh, &scene, NULL), STATUS_OK);
    }
    left_to_make = -1;
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_that_ends_anywhere_is_an_error),
        cmocka_unit_test(a_collapse_without_memory_leaves_the_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
