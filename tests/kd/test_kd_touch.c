/* What a ray reads of a k-d tree, as the cache model counts it: nodes, items and triangles are
 * arrays of their own, each line of which is read from memory once. No answer changes. */
#include "bench/measure/touch.h"
#include "scenes/rays/rays.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/kd/kd_fixture.h"

#define RAYS   200
#define ARRAYS 3

/* Lines of each array that have been read, and how many lookups that was. */
struct kd_lines {
    bool *read[ARRAYS];
    size_t count[ARRAYS];
    uint64_t lookups;
};

static void add_lines(void *user, enum kd_read array, ptrdiff_t number, size_t bytes)
{
    struct kd_lines *lines = user;
    const size_t first = (size_t)number * bytes / CACHE_SIM_LINE;
    const size_t last = ((size_t)number * bytes + bytes - 1) / CACHE_SIM_LINE;
    assert_true(number >= 0 && bytes > 0 && (size_t)array < ARRAYS);
    assert_true(last < lines->count[array]);
    for (size_t i = first; i <= last; i++)
        lines->read[array][i] = true;
    lines->lookups += last - first + 1;
}

static struct kd_lines lines_of(const struct kd_tree *tree)
{
    const uint64_t bytes[ARRAYS] = {
        [KD_READ_NODE] = kd_node_bytes(tree),
        [KD_READ_ITEM] = tree->item_count * sizeof *tree->item,
        [KD_READ_TRI] = tree->tri_count * sizeof *tree->tri,
    };
    struct kd_lines lines = {.lookups = 0};
    for (int a = 0; a < ARRAYS; a++) {
        lines.count[a] = (size_t)(bytes[a] + CACHE_SIM_LINE - 1) / CACHE_SIM_LINE;
        lines.read[a] = calloc(lines.count[a], sizeof *lines.read[a]);
        assert_non_null(lines.read[a]);
    }
    return lines;
}

static size_t distinct(struct kd_lines *lines)
{
    size_t count = 0;
    for (int a = 0; a < ARRAYS; a++) {
        size_t of_array = 0;
        for (size_t i = 0; i < lines->count[a]; i++)
            of_array += lines->read[a][i];
        count += of_array;
        free(lines->read[a]);
    }
    return count;
}

static void each_line_comes_from_memory_once(void **state)
{
    (void)state;
    static const struct cache_size large[CACHE_SIM_LEVELS] = {{1 << 14, 16}, {1 << 14, 16}};
    static struct ray ray[RAYS];
    size_t most = 0;
    for (size_t s = 0; s < KD_SCENES; s++) {
        const char *what;
        struct reason reason;
        struct scene scene = kd_scene(s, &what);
        struct kd_tree tree = kd_tree_of(&scene, what);
        struct kd_lines lines = lines_of(&tree);
        struct cache_sim cache;
        assert_int_equal(cache_sim_make(large, &cache, &reason), STATUS_OK);
        assert_int_equal(ray_set_make(ray_set_find("random"), &scene, 3, RAYS, ray, NULL),
                         STATUS_OK);
        for (size_t i = 0; i < RAYS; i++) {
            struct hit seen, own = kd_watched(&tree, &ray[i], add_lines, &lines);
            touch_kd(&tree, &ray[i], &cache, &seen);
            assert_memory_equal(&seen, &own, sizeof own);
        }
        size_t wanted = distinct(&lines);
        if (cache.counts.beyond[0] != wanted || cache.counts.lines != lines.lookups)
            fail_msg("%s: %llu lines of %llu lookups, not %zu of %llu", what,
                     (unsigned long long)cache.counts.beyond[0],
                     (unsigned long long)cache.counts.lines, wanted,
                     (unsigned long long)lines.lookups);
        most = wanted > most ? wanted : most;
        cache_sim_free(&cache);
        kd_free(&tree);
        scene_free(&scene);
    }
    assert_true(most > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_line_comes_from_memory_once)};
    return cmocka_run_group_tests_name("kd_touch", tests, NULL, NULL);
}
