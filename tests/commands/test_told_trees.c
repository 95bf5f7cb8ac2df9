/* What raydiff tree tells of a top level, of the trees below it and of rays that were aimed: each
 * tree by its number, and text and JSON alike, also where nothing was found. */
#define _GNU_SOURCE
#include "cmd/tree/cmd_tree_dump.h"

#include "tests/commands/told.h"

#define BELOW 3u

static const struct screen screen = {.width = 4000, .wide = true};

/* A top level with so many trees below it. */
static char *text_of(struct tree_told *told)
{
    told_begin(&stdout);
    tree_print(told, &screen);
    return told_end();
}

static size_t times(const char *text, const char *what)
{
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, what)) != NULL; at++)
        count++;
    return count;
}

static void trees_below_are_numbered(void **state)
{
    (void)state;
    for (size_t count = 0; count <= BELOW; count++) {
        static struct dump_instance instance[1];
        struct tree_dump below[BELOW] = {{.format = "f"}, {.format = "f"}, {.format = "f"}};
        struct tree_dump top = {.format = "f",
                                .instance = instance,
                                .tri_count = 1,
                                .below = below,
                                .below_count = (uint32_t)count};
        struct tree_told of[BELOW] = {{.file = "F"}, {.file = "F"}, {.file = "F"}};
        struct tree_told told = {.file = "F", .dump = &top, .has_scene = true, .below = of};
        for (size_t i = 0; i < count; i++) {
            of[i].dump = &below[i];
            of[i].tree = i + 1;
            of[i].has_scene = true;
        }
        char *text = text_of(&told);
        const char *at = text;
        for (size_t i = 0; i < count; i++) {
            char line[80];
            snprintf(line, sizeof line, "\nF, tree %zu below: a tree of format f, with its own",
                     i + 1);
            assert_int_equal(times(text, line), 1);
            assert_true(strstr(text, line) > at - (i == 0)); /* in their order */
            at = strstr(text, line);
        }
        assert_int_equal(times(text, " below: "), count);
        assert_int_equal(times(text, "F: a top level of format f, 1 instance, "), 1);
        assert_int_equal(times(text, "without the trees below\n"), count == 0);
        assert_int_equal(times(text, "with the trees below\n"), count > 0);
        free(text);
    }
}

/* Each of what was aimed, hit, lost and found is told by its number, if rays were aimed. */
static void aimed_rays_are_told(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 32; i++) {
        static struct dump_instance instance[1];
        struct tree_dump top = {.format = "f", .instance = instance, .tri_count = 1};
        const uint32_t is[] = {1000 + i, i & 2 ? 200 : 0, i & 4 ? 30 : 0, i & 8 ? 4 : 0};
        struct tree_told told = {.file = "F", .dump = &top};
        struct reason reason;
        char line[200];
        told.aimed = (struct tree_aimed){.done = i & 1,
                                         .tries = is[0],
                                         .aimed = is[1],
                                         .lost = is[2],
                                         .found = is[3],
                                         .instance = 7,
                                         .side = 5};
        snprintf(line, sizeof line,
                 "aimed %u rays; %u hit an instance outside of its box first; of these %u are "
                 "lost, and %u of those found in larger boxes\n",
                 is[0], is[1], is[2], is[3]);
        char *text = text_of(&told);
        told_squeeze(text);
        assert_int_equal(times(text, line), told.aimed.done);
        assert_int_equal(times(text, "aimed"), told.aimed.done);
        assert_int_equal(times(text, "LOST: instance 7, most z: ray "), told.aimed.done && is[3]);
        assert_int_equal(times(text, "LOST"), told.aimed.done && is[3]);
        free(text);
        assert_int_equal(tree_write_json(told_file(), &told, 1, &reason), STATUS_OK);
        json_t *json = told_file_json();
        static const char *const names[] = {"aimed", "hit", "lost", "found"};
        for (size_t k = 0; k < ARRAY_COUNT(names); k++) {
            assert_int_equal(json_object_get(json, names[k]) != NULL, told.aimed.done);
            if (told.aimed.done)
                assert_true(number_at(json, names[k]) == is[k]);
        }
        assert_true(number_at(json, "exit") == 1);
        json_decref(json);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_below_are_numbered),
        cmocka_unit_test(aimed_rays_are_told),
    };
    return cmocka_run_group_tests_name("told_trees", tests, NULL, NULL);
}
